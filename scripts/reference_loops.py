"""Areas of the loops of one elastic asperity, for the tests: what its jump-in and its jump-off dissipate.

Above λ_f = [9π/(16(π−1))]^(1/3) an asperity of the extended Maugis-Dugdale law touches at Δ₀ on its way there and lets go at the fold Δ_min of
its contact on its way back. Between the two the way there is before contact, the way back in contact: the loop has the area

    ∮F̂ dΔ = ∫ from Δ_min to Δ₀ of (F̂_there − F̂_back) dΔ.

Both are integrated here over their parameters, θ and z, in which they have closed forms: no inversion, no fold in the way.
The loops have two edges that are closed by roots: Δ(θ) = Δ₀ on the stable branch, and the outermost z with Δ(z) = Δ_min and Δ₀.

Usage: python scripts/reference_loops.py > tests/data/loops.csv
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["mpmath>=1.3"]
# ///

import mpmath as mp
from reference_values import contact_state, noncontact_state

mp.mp.dps = 40


def before(lam: mp.mpf, z: mp.mpf) -> tuple:
    """Δ and F̂_s of the extension before contact."""
    return noncontact_state(lam, mp.log(z - 1))[:2]


def derivative(f, x: mp.mpf) -> mp.mpf:
    return mp.diff(f, x)


def turning_point(f, low: mp.mpf, high: mp.mpf) -> mp.mpf:
    """Where f' changes its sign between two places that bracket it."""
    return crossing(lambda x: derivative(f, x), low, high)


def crossing(f, low: mp.mpf, high: mp.mpf) -> mp.mpf:
    """A zero of f between two places where its signs differ, by halving."""
    rises = f(high) > f(low)
    while high - low > mp.mpf(10) ** -32 * abs(high):
        middle = (low + high) / 2
        low, high = (low, middle) if (f(middle) > 0) == rises else (middle, high)
    return (low + high) / 2


def integral(f, level, low: mp.mpf, high: mp.mpf, parts: int) -> mp.mpf:
    """∫ f dlevel along a parameter."""
    places = mp.linspace(low, high, parts + 1)
    return mp.quad(lambda x: f(x) * derivative(level, x), places)


def loop_area(lam: mp.mpf) -> tuple:
    approach, attraction = (lambda theta: contact_state(lam, theta)[0]), (lambda z: before(lam, z)[0])
    touch = approach(mp.pi / 2)
    # The fold: Δ falls with θ up to there, and rises again to first touch.
    grid = mp.linspace(mp.mpf("0.01"), mp.pi / 2, 400)
    lowest = min(range(len(grid)), key=lambda i: approach(grid[i]))
    fold = turning_point(approach, grid[lowest - 1], grid[min(lowest + 1, len(grid) - 1)])
    release = approach(fold)
    stable = crossing(lambda theta: approach(theta) - touch, grid[0], fold)
    force = lambda theta: contact_state(lam, theta)[2] ** 3 - contact_state(lam, theta)[1]
    back = integral(force, approach, fold, stable, 8)
    # The outermost root before contact: z falls from far away until Δ is reached.
    def outermost(level: mp.mpf) -> mp.mpf:
        far = mp.mpf(200)
        while attraction(far) < level:
            far *= mp.mpf("0.995")
        return crossing(lambda z: attraction(z) - level, far, far / mp.mpf("0.995"))

    there = integral(lambda z: -before(lam, z)[1], attraction, outermost(release), outermost(touch), 12)
    return there - back, release, touch


def main() -> None:
    print("# Area of the loop of one asperity in units of s_F s_δ, and the approaches at which it lets go and touches.")
    print("lambda,area,release,touch")
    for text in ["1.2", "1.5", "2.4903", "5", "10"]:
        area, release, touch = loop_area(mp.mpf(text))
        print(",".join([text, *(mp.nstr(value, 20) for value in (area, release, touch))]))


if __name__ == "__main__":
    main()
