"""Offset and velocity of m e'' + d e' + k e = f at time t to 40 digits, from the roots of the law.

e(0) = 0.02, e'(0) = -0.3, f = 10. Made with mpmath 1.3: python3 inertial.py > inertial.csv
"""
from mpmath import exp, mp, mpc, mpf, nstr, sqrt

mp.dps = 40
LAWS = [(2, 50, 100), (1, 10, 25), (2, 5, 400), (5, 0, 300), (3, 40, 0), (2, 0, 0), (0.5, 100, 400), (1, 20.0002, 100)]


def solution(m, d, k, f, e, v, t):
    a, w2 = d / (2 * m), k / m
    root = sqrt(mpc(a * a - w2))
    if abs(root) < mpf(10) ** -15:
        phi, slope = t * exp(-a * t), (1 - a * t) * exp(-a * t)
    else:
        fast, slow = -a - root, -a + root
        phi = ((exp(slow * t) - exp(fast * t)) / (2 * root)).real
        slope = ((slow * exp(slow * t) - fast * exp(fast * t)) / (2 * root)).real
    if k:
        area = (1 - slope - 2 * a * phi) / w2
    else:
        area = (t - phi) / (2 * a) if d else t * t / 2
    pull = f / m - w2 * e
    return e + v * phi + pull * area, v + (pull - 2 * a * v) * phi - w2 * v * area


print("mass,damping,stiffness,time,offset,velocity")
for law in LAWS:
    for t in (1e-6, 1e-4, 1e-3, 0.01, 0.1, 1.0):
        e, v = solution(*map(mpf, law), mpf(10), mpf(0.02), mpf(-0.3), mpf(t))
        print(*law, t, nstr(e, 20), nstr(v, 20), sep=",")
