"""Writes coupled_step_exact.csv: one step of D e' + K e = f for the numbers of coupled_step.csv exactly as they are
printed there, to 60 digits, from the symmetric pencil of K and D (mpmath 1.3)."""
import csv
from pathlib import Path

from mpmath import cholesky, eigsy, exp, inverse, matrix, mp, mpf

mp.dps = 60
here = Path(__file__).parent


def symmetric(row, name):
    number = lambda key: mpf(float(row[name + key]))
    xx, xy, xz, yy, yz, zz = map(number, ["xx", "xy", "xz", "yy", "yz", "zz"])
    return matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


with open(here / "coupled_step.csv") as source, open(here / "coupled_step_exact.csv", "w") as out:
    print("ex_next,ey_next,ez_next", file=out)
    for row in csv.DictReader(source):
        vector = lambda name: matrix([mpf(float(row[name + axis])) for axis in "xyz"])
        dt, lower = mpf(float(row["dt_s"])), cholesky(symmetric(row, "d"))
        inverted = inverse(lower)
        pencil = inverted * symmetric(row, "k") * inverted.T
        rates, modes = eigsy((pencil + pencil.T) / 2)
        offset, force = modes.T * (lower.T * vector("e")), modes.T * (inverted * vector("f"))
        for i in range(3):
            left = exp(-rates[i] * dt)
            offset[i] = offset[i] * left + force[i] * (1 - left) / rates[i]
        print(*[repr(float(value)) for value in inverted.T * (modes * offset)], sep=",", file=out)
