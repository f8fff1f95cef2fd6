"""Areas of the loops of one elastic asperity: what its jump-in and its jump-off dissipate.

Above λ_f = [9π/(16(π−1))]^(1/3) an asperity of the extended Maugis-Dugdale law touches at Δ₀ on its way there
and lets go at the fold Δ_min of its contact on its way back. Between the two the way there is before contact,
the way back in contact:

    ∮F̂ dΔ = ∫ from Δ_min to Δ₀ of (F̂_there − F̂_back) dΔ.

Both are integrated over their parameters, θ and z, in which they have closed forms: no inversion, no fold in
the way. The edges are roots: Δ(θ) = Δ₀ on the stable branch, and the outermost z with Δ(z) = Δ_min and Δ₀.
Writes tests/data/loops.csv.
"""

import mpmath as mp
from fixtures import DATA, bisect
from reference_values import contact_state, noncontact_state

mp.mp.dps = 40
HEADER = """# Area of the loop of one asperity in units of s_F s_δ, and the approaches at which it lets go and
touches. lambda,area,release,touch
"""


def integral(f, level, low, high, parts):
    """∫ f dlevel along a parameter."""
    return mp.quad(lambda x: f(x) * mp.diff(level, x), mp.linspace(low, high, parts + 1))


def loop_area(lam):
    def contact(theta):
        return contact_state(lam, theta)

    def before(z):
        """Δ and F̂_s of the extension before contact."""
        return noncontact_state(lam, mp.log(z - 1))

    def outermost(level):
        """The root before contact: z falls from far away until Δ is reached."""
        far = mp.mpf(200)
        while before(far)[0] < level:
            far *= mp.mpf("0.995")
        return bisect(lambda z: before(z)[0] < level, far, far / mp.mpf("0.995"))

    approach, touch = (lambda theta: contact(theta)[0]), contact(mp.pi / 2)[0]
    # The fold: Δ falls with θ up to there, and rises again to first touch.
    grid = mp.linspace(mp.mpf("0.01"), mp.pi / 2, 400)
    lowest = min(range(len(grid)), key=lambda i: approach(grid[i]))
    low, high = grid[lowest - 1], grid[min(lowest + 1, len(grid) - 1)]
    fold = bisect(lambda theta: mp.diff(approach, theta) > 0, low, high)
    stable = bisect(lambda theta: approach(theta) < touch, grid[0], fold)
    back = integral(lambda theta: contact(theta)[2] ** 3 - contact(theta)[1], approach, fold, stable, 8)
    ends = outermost(approach(fold)), outermost(touch)
    there = integral(lambda z: -before(z)[1], lambda z: before(z)[0], *ends, 12)
    return there - back, approach(fold), touch


if __name__ == "__main__":
    rows = [[text, *(mp.nstr(value, 20) for value in loop_area(mp.mpf(text)))]
            for text in "1.2 1.5 2.4903 5 10".split()]
    (DATA / "loops.csv").write_text(HEADER + "".join(",".join(row) + "\n" for row in rows), encoding="utf-8")
