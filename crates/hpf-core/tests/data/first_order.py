"""Offset of d e' + k e = f at time t to 40 digits, e(0) = 0.02, f = 10: python3 first_order.py > first_order.csv"""
from decimal import Decimal, getcontext

getcontext().prec = 60
LAWS = [("50", "100"), ("10", "400"), ("100", "30"), ("3", "1000000"), ("40", "0"), ("50", "1e-9")]

print("damping,stiffness,time,offset")
for d, k in LAWS:
    for t in ("1e-6", "1e-4", "1e-3", "0.01", "0.1", "1", "10"):
        damping, stiffness, time, force, start = map(Decimal, (d, k, t, "10", "0.02"))
        if stiffness:
            left = (-stiffness * time / damping).exp()
            offset = start * left + force / stiffness * (1 - left)
        else:
            offset = start + force * time / damping
        print(d, k, t, f"{offset:.40g}", sep=",")
