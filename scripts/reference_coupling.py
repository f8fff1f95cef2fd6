"""Reference values of elastically coupled asperities, for the tests: writes tests/data/coupling.json.

Nothing of it comes from the program. The equations and their dense solution are in coupled_asperities.py;
what concerns one or two asperities is solved here by mpmath in 30 digits. Sections of the file:

* `green`: pi E* L G of a square cell that repeats, by the sum of Ewald with two splittings that agree;
* `mean_field`: c of a square patch under uniform pressure, its mean displacement being c p L / E*;
* `surfaces`: places, heights and radii, drawn here once (random sequential addition for the places);
* `ensembles`: states of such surfaces, and of pairs and of one asperity, at given separations.

Every number of an input is the double nearest to its decimals. It takes a minute.
"""

import json
import sys

import mpmath as mp
import numpy as np
from coupled_asperities import (
    JKR_END, LAWS, Asperities, follow, green_matrix, hertz, lattice, solve, stability, steps,
)  # fmt: skip
from fixtures import DATA

mp.mp.dps = 30
MODULUS, RADIUS, WORK, SPACING = 85.29e9, 3.33e-6, 0.09, 0.2e-9  # case II
SPLITTINGS = "1.2", "2.5"
PLACES = [(0, 0), (0.5, 0.5), (0.5, 0), (0, 0.5), (0.25, 0.25), (0.001, 0), (0.0001, -0.0003), (0.01, 0.02),
          (0.1, 0.3), (0.3, 0.1),
          (-0.4, 0.15), (0.49, 0.02), (1.25, -3.5), (0.7, 0.95)]


# --- Surfaces


def hard_core(rng, count, side, distance):
    """Places in a square that repeats, each at least `distance` from those before, in whole picometres."""
    places, found = np.empty((count, 2)), 0
    while found < count:
        place = np.round(rng.random(2) * side, 12)
        gaps = place - places[:found]
        if np.all(np.hypot(*(gaps - side * np.rint(gaps / side)).T) >= distance):
            places[found] = place
            found += 1
    return places.tolist()


def surfaces():
    """Three surfaces of case II: 30 asperities, these with radii of their own, 200; one that is 16 times
    smoother; pairs; one."""
    found = {}
    for name, count, side, seed in [("thirty", 30, 2e-6, 17), ("two hundred", 200, 5.2e-6, 18)]:
        rng = np.random.Generator(np.random.PCG64(seed))
        places = hard_core(rng, count, side, 0.184e-6)
        heights = np.round(1.6e-9 * rng.standard_normal(count), 15).tolist()
        found[name] = {"cell": side, "places": places, "heights": heights, "radii": [RADIUS] * count}
        if count == 30:
            radii = np.round(RADIUS * np.exp(0.3 * rng.standard_normal(count)), 10).tolist()
            found["thirty radii"] = {**found[name], "radii": radii}
            found["thirty smooth"] = {**found[name], "heights": np.round(np.array(heights) / 16, 15).tolist()}
    pair = {"cell": 1e-6, "places": [[2e-7, 3e-7], [6e-7, 5e-7]], "heights": [1e-9, 0.0],
            "radii": [RADIUS] * 2}
    found["pair"] = pair
    found["near pair"] = {**pair, "places": [[2e-7, 3e-7], [3.2e-7, 3.5e-7]]}
    found["equal pair"] = {**pair, "heights": [0.0, 0.0], "radii": [RADIUS] * 2}
    found["one"] = {"cell": 1e-6, "places": [[2e-7, 3e-7]], "heights": [0.0], "radii": [RADIUS]}
    return found


# --- One and two asperities, in 30 digits


def mp_force(law, delta, radius):
    stiffness, unit = 4 * mp.mpf(MODULUS) / 3, mp.pi * radius * mp.mpf(WORK)
    contact = stiffness * mp.sqrt(radius) * mp.sqrt(max(delta, 0)) ** 3
    if law == "hertz":
        return contact
    if law == "dmt":
        return contact - 2 * unit if delta >= 0 else mp.mpf(0)
    if law == "idmt":
        s = mp.mpf(SPACING) / (mp.mpf(SPACING) - min(delta, 0))
        return contact - mp.mpf(8) / 3 * unit * (s**2 - s**8 / 4)
    length = mp.cbrt((mp.pi * mp.mpf(WORK) / stiffness) ** 2 * radius)
    end = mp.mpf(6) ** (-mp.mpf(1) / 3)
    # A is the largest zero of Delta(A) - Delta, which lies above `end` and below this:
    scaled, high = delta / length, 2 + mp.sqrt(abs(delta / length)) * 2
    a = mp.findroot(lambda a: a * a - 2 * mp.sqrt(6 * a) / 3 - scaled, (end, high), solver="anderson",
                    tol=1e-50, maxsteps=200)
    return unit * (a**3 - a * mp.sqrt(6 * a))


def mp_green(surface, periodic):
    count, side, scale = len(surface["places"]), mp.mpf(surface["cell"]), mp.pi * mp.mpf(MODULUS)
    green = mp.matrix(count, count)
    for i in range(count):
        for j in range(count):
            x, y = (mp.mpf(p) - mp.mpf(q) for p, q in zip(surface["places"][i], surface["places"][j]))
            if periodic:
                green[i, j] = lattice(x / side, y / side) / (scale * side)
            elif i != j:
                green[i, j] = 1 / (scale * mp.hypot(x, y))
    return green


def few(law, surface, periodic, separation):
    """One or two asperities at a separation: approaches and forces to 30 digits, polished from the dense
    solution."""
    green, target = mp_green(surface, periodic), [mp.mpf(z) - mp.mpf(separation) for z in surface["heights"]]
    count, radius = len(target), mp.mpf(RADIUS)
    unit = mp.mpf("1e-9")

    def residual(*scaled):
        forces = [mp_force(law, value * unit, radius) for value in scaled]
        return [scaled[i] - (target[i] - sum(green[i, j] * forces[j] for j in range(count))) / unit
                for i in range(count)]

    start = dense(law, surface, periodic, [separation])[0].approach
    begin = [mp.mpf(float(value)) / unit for value in start]
    approaches = [value * unit for value in mp.findroot(residual, begin, tol=1e-52, maxsteps=60)]
    if any(abs(float(value) - float(other)) > 1e-15 * float(unit) for value, other in zip(approaches, start)):
        raise ValueError(f"{law} at {separation}: the dense solution is another")
    forces = [mp_force(law, value, radius) for value in approaches]
    return {"separation": separation, "approaches": approaches, "forces": forces}


# --- Ensembles


RAMP = np.longdouble("1e-27")  # m, over which the law of an asperity that rests at its touch jumps


def with_sets(touched, resting):
    """The law of DMT where it is given which asperities have touched, and which rest at the touch with a
    force in between."""

    def law(asperity, delta):
        force, slope = hertz(asperity, delta)
        pull = LAWS["dmt"](asperity, np.zeros_like(delta))[0]
        force, slope = np.where(touched, force + pull, 0), np.where(touched, slope, 0)
        return np.where(resting, pull * (delta / RAMP + 0.5), force), np.where(resting, pull / RAMP, slope)

    return law


def dmt_path(asperity, heights, green, separations):
    """States of DMT along separations: the asperity that is furthest on the wrong side of its touch flips,
    one at a time.

    One that flips a third time at a separation rests at its touch. None where no sets agree with themselves.
    """
    heights = np.array(heights, np.longdouble)
    delta = heights - np.longdouble(separations[0])
    touched, states = delta >= 0, []
    for separation in separations:
        flips, resting = np.zeros(len(delta), int), np.zeros(len(delta), bool)
        for _ in range(6 * len(delta) + 10):
            state = solve(with_sets(touched, resting), asperity, heights, green, separation, delta)
            delta = np.where(resting, 0, state.approach)
            wrong = np.where(touched, -state.approach, state.approach)
            wrong = np.where(resting, np.abs(state.approach) - RAMP / 2, wrong)
            if np.max(wrong) <= 0:
                states.append(state._replace(approach=delta))
                break
            worst = np.argmax(wrong)
            touched[worst] = touched[worst] ^ (not resting[worst])
            flips[worst] += 1
            resting[worst] = flips[worst] > 2 and not resting[worst]
        else:
            states.append(None)
        touched = touched & ~resting
    return states


def dense(law, surface, periodic, separations):
    """States at the separations, on the way down to each of them from afar, but `jkr` on the way back from
    contact of all."""
    asperity = Asperities(np.array(surface["radii"], np.longdouble), MODULUS, WORK, SPACING)
    green = green_matrix(surface["places"], MODULUS, surface["cell"] if periodic else None)
    heights = surface["heights"]
    found, low, high = [], min(heights), max(heights)
    if law == "dmt":
        for separation in separations:
            down = dmt_path(asperity, heights, green, steps(high + 1e-9, separation, 2e-10))[-1]
            back = dmt_path(asperity, heights, green, steps(separation - 1e-9, separation, 2e-10))[-1]
            if None in (down, back) or np.max(np.abs(down.approach - back.approach)) > 1e-20:
                raise ValueError(f"dmt at {separation}: the history counts, or no state was found")
            found.append(down)
        return found
    places = [low - 1e-9 if law == "jkr" else high + 1e-9, *separations]
    path = places[:1] + [s for a, b in zip(places, places[1:]) for s in steps(a, b, 1e-10)[1:]]
    states = follow(LAWS[law], asperity, heights, green, path)
    if min(stability(LAWS[law], asperity, green, state) for state in states) <= 0:
        raise ValueError(f"{law}: a state on the way is not stable")
    return [next(state for state in states if state.separation == s) for s in separations]


def margin(law, surface, state):
    """The least distance, in m, of an approach from where its law jumps or ends; None for laws that do
    neither."""
    if law == "dmt":
        return float(np.min(np.abs(state.approach[state.approach != 0])))
    if law == "jkr":
        asperity = Asperities(np.array(surface["radii"], np.longdouble), MODULUS, WORK)
        return float(np.min(state.approach - JKR_END * asperity.length))
    return None


FEW = [  # surface, law, coupling, separations
    ("pair", "hertz", "patch", [5e-10, -5e-10, -2e-9]),
    ("pair", "hertz", "periodic", [5e-10, -5e-10, -2e-9]),
    ("pair", "dmt", "patch", [5e-10, -5e-10, -2e-9]),
    ("pair", "dmt", "periodic", [5e-10, -5e-10, -2e-9]),
    ("pair", "idmt", "patch", [2e-9, 1.1e-9, 5e-10, -5e-10]),
    ("pair", "idmt", "periodic", [2e-9, 1.1e-9, 5e-10, -5e-10]),
    ("near pair", "hertz", "patch", [5e-10, -5e-10]),
    ("near pair", "dmt", "patch", [5e-10, -5e-10]),
    ("equal pair", "hertz", "patch", [-1e-10, -1e-9]),
    ("equal pair", "jkr", "patch", [-1e-9, 0.0, 2e-10]),
    ("equal pair", "jkr", "periodic", [-1e-9, 0.0, 2e-10]),
    ("one", "hertz", "periodic", [-1e-11, -1e-10, -1e-9, -5e-9, -1.4e-8]),
    ("one", "jkr", "periodic", [-1e-9, 0.0, 1.5e-10]),
]
MANY = [
    ("thirty", "hertz", "periodic", [3e-9, 1e-9, 0.0, -1.5e-9]),
    ("thirty", "hertz", "patch", [3e-9, 1e-9, -1e-9, -3e-9]),
    ("thirty radii", "hertz", "periodic", [3e-9, 1e-9, -1e-9]),
    ("thirty radii", "hertz", "patch", [3e-9, 1e-9, -1e-9]),
    ("thirty", "dmt", "periodic", [4e-9, 2.4e-9, 1e-9, -2e-10]),
    ("thirty", "dmt", "patch", [4e-9, 2.2e-9, 1e-9, -2e-10]),
    ("thirty", "idmt", "periodic", [5e-9, 3.5e-9, 2e-9, 5e-10]),
    ("thirty", "idmt", "patch", [5e-9, 3.5e-9, 2e-9, 5e-10]),
    ("thirty smooth", "jkr", "periodic", [-8e-10, -4e-10, -2e-10, 0.0]),
    ("thirty smooth", "jkr", "patch", [-8e-10, -3e-10, 0.0, 2e-10]),
    ("two hundred", "hertz", "periodic", [2.5e-9, 1e-9, -5e-10]),
    ("two hundred", "hertz", "patch", [2.5e-9, 0.0, -2.5e-9]),
    ("two hundred", "dmt", "periodic", [2.8e-9, 1.6e-9, 2e-10]),
    ("two hundred", "dmt", "patch", [2.8e-9, 1.6e-9, 1e-9]),
    ("thirty", "dmt", "periodic", [0.0]),  # in these states one or two asperities rest at their touch
    ("two hundred", "dmt", "periodic", [1.8e-9, 8e-10]),
    ("two hundred", "dmt", "patch", [0.0]),
]


def ensembles(surfaces):
    found = []
    for name, law, coupling, separations in FEW + MANY:
        print(name, law, coupling, file=sys.stderr)
        surface, periodic = surfaces[name], coupling == "periodic"
        if len(surface["places"]) > 2:
            states = dense(law, surface, periodic, separations)
            rows = [{"separation": state.separation, "approaches": state.approach, "forces": state.force,
                     "margin": margin(law, surface, state)} for state in states]
        else:
            rows = [few(law, surface, periodic, separation) for separation in separations]
        found.append({"surface": name, "law": law, "coupling": coupling, "states": rows})
    return found


def green_values():
    rows = []
    for x, y in PLACES:
        values = [lattice(x, y, splitting) for splitting in SPLITTINGS]
        if abs(values[0] - values[1]) > mp.mpf(10) ** -25 * (1 + abs(values[0])):
            raise ValueError(f"two splittings differ at {x}, {y}")
        rows.append([mp.mpf(x), mp.mpf(y), values[0]])
    return rows


def rest(surface):
    """One asperity of DMT in a periodic cell that rests at its touch: force between 0 and -2 pi R work, so
    that d = z - G f."""
    green = mp_green(surface, True)[0, 0]
    jump = 2 * mp.pi * mp.mpf(RADIUS) * mp.mpf(WORK)
    rows = []
    for share in (0.25, 0.75):
        separation = float(green * jump
                           * share)  # negative: the asperity would be in contact if it were rigid
        rows.append({"separation": separation, "approaches": [mp.mpf(0)],
                     "forces": [-mp.mpf(separation) / green]})
    return [{"surface": "one", "law": "dmt", "coupling": "periodic", "states": rows}]


# --- The file


def text(value, indent = ""):
    """JSON with 20 digits of what mpmath computed and 18 of long doubles; lists of numbers on one line."""
    if isinstance(value, mp.mpf):
        return mp.nstr(value, 20, min_fixed=0, max_fixed=0) if value else "0.0"
    if isinstance(value, np.longdouble):
        return np.format_float_scientific(value, precision=17, unique=False) if value else "0.0"
    if isinstance(value, dict):
        inner = [f'{indent} "{key}": {text(item, indent + " ")}' for key,
                 item in value.items() if item is not None]
        return "{\n" + ",\n".join(inner) + "\n" + indent + "}"
    if isinstance(value, (list, tuple, np.ndarray)):
        flat = not any(isinstance(item, dict) for item in value)
        items = [text(item, indent + " ") for item in value]
        if flat:
            return "[" + ", ".join(items) + "]"
        return "[\n" + ",\n".join(indent + " " + item for item in items) + "\n" + indent + "]"
    return json.dumps(value)


def content():
    drawn = surfaces()
    return {
        "origin": "scripts/reference_coupling.py",
        "reduced_modulus": MODULUS, "work_of_adhesion": WORK, "equilibrium_spacing": SPACING,
        "mean_field": 4 / mp.pi * (mp.log(1 + mp.sqrt(2)) + (1 - mp.sqrt(2)) / 3),
        "green": green_values(),
        "surfaces": drawn,
        "ensembles": ensembles(drawn) + rest(drawn["one"]),
    }


def write_json(name, content):
    (DATA / name).write_text(text(content) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write_json("coupling.json", content())
