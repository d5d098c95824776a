#!/usr/bin/env python3
"""Writes hard rays at planes, disks, cuboids and triangles with their exact hits: rays_flat.py SEED ROWS > rays_flat.jsonl

Every input is a float and taken as exact; hits are computed with fractions, normals and margins with 120 decimal
digits. One object a line: id, family, shape, origin, direction, t_min, t_max, hits [{t (50 digits), normal}], margin
(a lower bound of the distance, over the scale of the scene, by which the ray must move before the count of hits
changes), cond (1 / |n . d|, d as unit vector), crease (distance to the nearest edge of a cuboid times |n . d|, over the scale), ncond,
size. Unlike simple lists of families the rows combine difficulties: every row draws a scale, a place in the world,
a distance of the origin, a length of the direction, a way to aim and an interval on its own.
Standard library only."""
import json, math, random, sys
from decimal import Decimal as D, getcontext
from fractions import Fraction as F
getcontext().prec = 120
getcontext().Emax = 999999
getcontext().Emin = -999999

def dec(x): return D(x.numerator) / D(x.denominator)
def vec(v): return [F(x) for x in v]
def sub(a, b): return [x - y for x, y in zip(a, b)]
def add(a, b): return [x + y for x, y in zip(a, b)]
def mul(a, s): return [x * s for x in a]
def dot(a, b): return sum(x * y for x, y in zip(a, b))
def cross(a, b): return [a[1]*b[2]-a[2]*b[1], a[2]*b[0]-a[0]*b[2], a[0]*b[1]-a[1]*b[0]]
def length(a): return dec(dot(a, a)).sqrt()
def floats(v): return [float(x) for x in v]

R = random.Random()

def unit():
    while True:
        v = [R.gauss(0, 1) for _ in range(3)]
        n = math.sqrt(sum(x*x for x in v))
        if n > 0.1: return [x / n for x in v]

def axis_like(v):
    """Sometimes a vector with one or two zero components of either sign."""
    if R.random() < 0.25:
        keep = R.sample(range(3), R.choice([1, 1, 2]))
        v = [x if i in keep else R.choice([0.0, -0.0]) for i, x in enumerate(v)]
        if all(x == 0 for x in v): v[R.randrange(3)] = 1.0
    return v

def make_shape(kind, s, at):
    k = 10.0**R.choice([0, 0, 0, R.uniform(-140, 140)])
    if kind == 'plane':
        return dict(point=floats(at), normal=[x * k for x in axis_like(unit())])
    if kind == 'disk':
        return dict(center=floats(at), normal=[x * k for x in axis_like(unit())], radius=s * R.uniform(0.3, 1))
    if kind == 'cuboid':
        half = [s * R.uniform(0.3, 1) * R.choice([1, 1, 1, 10.0**R.uniform(-12, 0)]) for _ in range(3)]
        lo, hi = floats([float(a) - h for a, h in zip(at, half)]), floats([float(a) + h for a, h in zip(at, half)])
        return dict(min=lo, max=hi)
    a, b, c = (floats([float(p) + s * R.uniform(-1, 1) for p in at]) for _ in range(3))
    if R.random() < 0.35:  # sliver
        f, e = R.uniform(0, 1), s * 10.0**R.uniform(-14, -2)
        c = [p + f * (q - p) + e * g for p, q, g in zip(a, b, unit())]
    return dict(a=a, b=b, c=c)

def point_on(kind, q, s):
    """A point on the shape, often at or near its border."""
    edge = R.choice([0, 0, 1, 2])
    tiny = R.choice([0.0, R.choice([-1, 1]) * 10.0**R.uniform(-15, -3)])
    if kind == 'plane':
        n = vec(q['normal']); p = vec(q['point']); k = max(range(3), key=lambda i: abs(n[i]))
        scale = F(s) * F(10.0**R.uniform(-9, 3))
        v = [F(R.uniform(-1, 1)) * scale for _ in range(3)]
        v[k] = -sum(n[i] * v[i] for i in range(3) if i != k) / n[k]
        return add(p, v)
    if kind == 'disk':
        n = vec(q['normal']); k = max(range(3), key=lambda i: abs(n[i]))
        v = [F(R.uniform(-1, 1)) for _ in range(3)]
        v[k] = -sum(n[i] * v[i] for i in range(3) if i != k) / n[k]
        r = F(q['radius']) / F(float(length(v)) or 1.0)
        return add(vec(q['center']), mul(v, r * F(R.uniform(0, 1) if edge == 0 else 1 + tiny)))
    if kind == 'cuboid':
        lo, hi = vec(q['min']), vec(q['max'])
        f = [F(R.uniform(0, 1)) for _ in range(3)]
        for i in R.sample(range(3), 1 + edge): f[i] = F(R.choice([0, 1])) + F(tiny if edge else 0)
        return [a + (b - a) * x for a, b, x in zip(lo, hi, f)]
    a, b, c = vec(q['a']), vec(q['b']), vec(q['c'])
    u, v = R.random(), R.random()
    if u + v > 1: u, v = 1 - u, 1 - v
    if edge == 1: u = tiny
    if edge == 2: u, v = R.choice([(0, 0), (1, 0), (0, 1)]); u += tiny
    return add(a, add(mul(sub(b, a), F(u)), mul(sub(c, a), F(v))))

def normal_of(kind, q):
    if kind == 'triangle': return cross(sub(vec(q['b']), vec(q['a'])), sub(vec(q['c']), vec(q['a'])))
    return vec(q['normal'])

def crossings(kind, q, o, d):
    """[(t, normal, rim)], events: [(kind, ...)] and the margin of the line, as length."""
    dn = length(d)
    if kind == 'cuboid':
        lo, hi = vec(q['min']), vec(q['max'])
        near, far, margin_miss, pairs = {}, {}, None, []
        for i in range(3):
            if d[i] == 0:
                out = max(lo[i] - o[i], o[i] - hi[i])
                pairs.append(dec(-out))
                continue
            a, b = (lo[i] - o[i]) / d[i], (hi[i] - o[i]) / d[i]
            near[i], far[i] = min(a, b), max(a, b)
        for i in near:
            for j in far:
                if i != j:
                    gap = dec(far[j] - near[i])
                    pairs.append(gap * abs(dec(d[i])) * abs(dec(d[j])) / dec(d[i]**2 + d[j]**2).sqrt())
        bad = [p for p in pairs if p <= 0]
        if bad: return [], -min(bad)
        i = max(near, key=lambda k: near[k]); j = min(far, key=lambda k: far[k])
        out = []
        for t, k, s in ((near[i], i, -1), (far[j], j, 1)):
            n = [F(0)]*3; n[k] = F(s if d[k] > 0 else -s)
            p = add(o, mul(d, t))
            rim = min(min(p[m] - lo[m], hi[m] - p[m]) for m in range(3) if m != k)
            out.append((t, n, dec(rim)))
        return out, min(pairs)
    n = normal_of(kind, q)
    nn = length(n)
    den = dot(n, d)
    c = vec(q['point'] if kind == 'plane' else q['center'] if kind == 'disk' else q['a'])
    cos = abs(dec(den)) / nn / dn
    if den == 0:
        return [], D(0)
    t = dot(n, sub(c, o)) / den
    p = add(o, mul(d, t))
    if kind == 'plane': return [(t, n, None)], None
    if kind == 'disk':
        rho = length(sub(p, c)); gap = dec(F(q['radius'])) - rho
        return ([(t, n, None)] if gap >= 0 else []), abs(gap) * cos
    v = [vec(q[k]) for k in 'abc']
    gaps = []
    for k in range(3):
        e = sub(v[(k+1) % 3], v[k])
        gaps.append(dec(dot(cross(e, sub(p, v[k])), n)) / nn / length(e))
    if min(gaps) >= 0: return [(t, n, None)], min(gaps) * cos
    return [], -min(gaps) * cos

def size_of(kind, q):
    if kind == 'plane': return 0.0
    if kind == 'disk': return q['radius']
    ps = [q['min'], q['max']] if kind == 'cuboid' else [q[k] for k in 'abc']
    return max(max(p[i] for p in ps) - min(p[i] for p in ps) for i in range(3)) / 2

def centre_of(kind, q):
    if kind in ('plane', 'disk'): return vec(q['point'] if kind == 'plane' else q['center'])
    ps = [q['min'], q['max']] if kind == 'cuboid' else [q[k] for k in 'abc']
    return [sum(F(p[i]) for p in ps) / len(ps) for i in range(3)]

def text(t):
    getcontext().prec = 50
    s = str(dec(t))
    getcontext().prec = 120
    return s

def row(kind):
    scale = 10.0**R.choice([0, 0, 0, R.uniform(-9, 9), R.uniform(-140, 140)])
    world = R.choice([0, 0, 1, 10.0**R.uniform(0, 12)])
    at = mul(vec(unit()), F(scale) * F(world))
    q = make_shape(kind, scale, at)
    target = point_on(kind, q, scale)
    how = R.choice(['aimed', 'aimed', 'aimed', 'grazing', 'surface', 'axis'])
    distance = F(scale) * F(10.0**R.choice([0, R.uniform(-3, 3), R.uniform(0, 12)]))
    away = unit()
    if how == 'grazing' or how == 'surface' and R.random() < 0.5:
        n = normal_of(kind, q) if kind != 'cuboid' else vec(unit())
        nf = [float(dec(x) / length(n)) for x in n]
        h = sum(a * b for a, b in zip(away, nf))
        lift = R.choice([-1, 1]) * 10.0**R.uniform(-15, -1)
        away = [a - h * b + lift * b for a, b in zip(away, nf)]
    if how == 'axis':
        away = axis_like(away)
    o = floats(add(target, mul(vec(away), distance)))
    d = floats(sub(target, vec(o)))
    if how == 'axis':
        d = [x if y != 0 else R.choice([0.0, -0.0]) for x, y in zip(d, away)]
    if all(x == 0 for x in d): return None
    k = 2.0**-math.frexp(max(abs(x) for x in d))[1]
    d = [x * k * R.uniform(0.5, 1) if how != 'axis' else x * k for x in d]
    stretch = 10.0**R.choice([0, 0, R.uniform(-12, 12), R.uniform(-150, 150)])
    d = [x * stretch for x in d]
    if how == 'surface':  # a secondary ray: starts at a hit rounded to floats
        o = floats(target)
    O, V = vec(o), vec(d)
    line, margin = crossings(kind, q, O, V)
    t_min, t_max = 0.0, 1e308
    family = how
    if line and (how == 'surface' or R.random() < 0.3):
        family += '_interval'
        t = float(R.choice(line)[0])
        near = t * (1 + R.choice([-1, 1]) * 10.0**R.uniform(-15, -0.5))
        if how == 'surface' and R.random() < 0.5:
            near = 10.0**R.uniform(-12, 0) * float(scale) / float(length(V))
        if R.random() < 0.5: t_min = max(0.0, near)
        else: t_max = near if near > 0 else t_max
        if R.random() < 0.2 and t > 0: t_min, t_max = sorted([t * (1 - 10.0**R.uniform(-12, -1)), t * (1 + 10.0**R.uniform(-12, -1))])
    if not t_min < t_max: return None
    dn = length(V)
    S = max(length(O), length(centre_of(kind, q)) + dec(F(size_of(kind, q))) * 2)
    for end in [t_min] * (t_min > 0) + [t_max] * (t_max < 1e308): S = max(S, length(add(O, mul(V, F(end)))))
    if kind == 'plane':
        for t, _, _ in line: S = max(S, length(add(O, mul(V, t))))
    margins = [] if margin is None else [margin]
    for t, n, _ in line:
        cos = abs(dec(dot(n, V))) / length(n) / dn
        if kind == 'plane' and t_max >= 1e308: margins.append(cos * S)
        for end in [t_min] + ([t_max] if t_max < 1e308 else []): margins.append(abs(dec(t - F(end))) * dn * cos)
    if kind == 'plane' and not line: margins.append(D(0))
    hits, cond, crease = [], [], []
    for t, n, rim in line:
        if F(t_min) < t < F(t_max):
            nn = length(n)
            cos = abs(dec(dot(n, V))) / nn / dn
            hits.append(dict(t=text(t), normal=[float(dec(x) / nn) for x in n]))
            cond.append(float(1 / cos))
            Sc = max(length(O), length(add(O, mul(V, t))), dec(F(size_of(kind, q))))
            crease.append(None if rim is None else float(rim * cos / Sc) if Sc else 0.0)
    if any(not math.isfinite(x) for v in list(q.values()) + [o, d] for x in (v if isinstance(v, list) else [v])): return None
    if any(not 0 < abs(float(h['t'])) < 1e300 and float(h['t']) != 0 for h in hits): return None
    if S == 0: return None
    return dict(family=family, shape={kind: q}, origin=o, direction=d, t_min=t_min, t_max=t_max, hits=hits,
                margin=float(min(margins) / S), cond=cond, crease=crease, ncond=[1.0] * len(hits), size=size_of(kind, q))

def main():
    R.seed(int(sys.argv[1]))
    for i in range(int(sys.argv[2])):
        kind = ['plane', 'disk', 'cuboid', 'triangle'][i % 4]
        while True:
            try: r = row(kind)
            except (OverflowError, ZeroDivisionError): r = None
            if r is not None: break
        print(json.dumps(dict(id=i, **r)))

main()
