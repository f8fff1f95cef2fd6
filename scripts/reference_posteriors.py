"""Exact posteriors of the work of adhesion and of a second parameter from pull-off forces: writes
tests/data/posteriors.json.

A patch has N asperities of DMT, f(δ) = K√R δ^(3/2) − 2πRΔγ for δ ≥ 0 and 0 before, with K = 4E*/3. As the
surfaces approach, its force falls only where an asperity touches. So its largest attraction is at one of these
places,

    F = A g, A = 2πRΔγ, g = max_k (k − c D_k), D_k = Σ_{j<k} (s_j − s_k)^(3/2), c = K σ_s^(3/2) / (2π√R Δγ),

where s_1 > s_2 > … are the N heights over σ_s, standard normal numbers. D_k has no parameter: the patches that
are drawn serve all parameters, and g depends on c alone. The likelihood is a table over ln A and ln c, in which
the logarithms of Δγ, R and σ_s are linear.

* Without errors of measurement ln g has a smooth density. Its estimate is by a kernel of fourth order, φ − φ″/2
  with a width of 0.03, a fifth of the scatter or less, on counts of patches in bins of 0.0005.
* With errors the density of a measured force is the mean of Gaussians about the forces of all patches. Nothing
  is smoothed, and the steps of patches that one, two or three asperities hold are in it.

The posterior is likelihood times prior on 257 values of c by 201 of A (with one prior, on 257 of Δγ) over seven
standard deviations each way, which a first grid over the whole prior has found.

How exact, over the posterior's standard deviation: `mean_error` and `std_error` are Monte Carlo errors of mean
and standard deviation, from eight parts of the patches; `mean_bias` is the bias of the mean that is left of that
of the parts; `halved_width` and `halved_grid` are its shifts by a kernel half as wide, and by half of the values
of c. The script stops if one of the mean is above 0.03.

Scenes are as the program reads them, forces and errors in N, posteriors in SI units. The forces are drawn here,
and the likelihood has other random numbers. Run time: three minutes of one core.
"""

import numpy as np
from reference_coupling import write_json
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d
from scipy.special import logsumexp

BIN, WIDTH = 5e-4, 0.03
PARTS, CHUNK = 8, 10_000
COARSE, MOST = 200_000, 0.03
ENERGY, RADIUS, HEIGHTS = "material.work_of_adhesion", "surface.asperity_radius", "surface.asperity_height_std"
QUANTILES = {"low": 0.025, "median": 0.5, "high": 0.975}
UNITS = {ENERGY: "J/m^2", RADIUS: "m", HEIGHTS: "m"}
WIDE = {"prior": "log_uniform", "from": 0.01, "to": 0.25}
# Asperities, E* in Pa, true values and priors in SI units, number of forces and their error in N, simulated patches.
AUDITS = {
    "one prior, 30 forces": (50, 4e9, {ENERGY: 0.05, RADIUS: 1e-6, HEIGHTS: 1e-9}, {ENERGY: WIDE}, 30, 0.0, 2_000_000),
    "few asperities, 50 forces": (20, 20e9, {ENERGY: 0.05, RADIUS: 1e-6, HEIGHTS: 1e-9},
                                  {ENERGY: WIDE, RADIUS: {"prior": "log_normal", "median": 1.1e-6, "log_std": 0.3}}, 50, 1e-8, 2_000_000),
    "two priors, 200 forces": (50, 4e9, {ENERGY: 0.05, RADIUS: 1e-6, HEIGHTS: 0.9e-9},
                               {ENERGY: WIDE, HEIGHTS: {"prior": "log_normal", "median": 1e-9, "log_std": 0.3}}, 200, 0.0, 4_000_000),
    "two priors, 2000 forces": (50, 4e9, {ENERGY: 0.05, RADIUS: 1e-6, HEIGHTS: 0.9e-9},
                                {ENERGY: WIDE, HEIGHTS: {"prior": "log_normal", "median": 1e-9, "log_std": 0.3}}, 2000, 0.0, 20_000_000),
}  # fmt: skip


def depths(heights):
    """D_k of patches by their heights over σ_s, (asperities, patches)."""
    s = -np.sort(-heights, axis=0)
    result = np.zeros_like(s)
    for k in range(1, len(s)):
        apart = s[:k] - s[k]
        result[k] = (apart * np.sqrt(apart)).sum(axis=0)
    return result


def pulls(depth, c):
    """g of patches, (patches,)."""
    best = np.zeros(depth.shape[1])
    for k, row in enumerate(depth, 1):
        np.maximum(best, k - c * row, out=best)
    return best


def counts(random, patches, count, c):
    """Patches in bins of ln g, the first about 0, for each part and each c, (parts, c, bins)."""
    bins = int(np.log(count) / BIN) + 2
    result = np.zeros((PARTS, len(c), bins))
    for number in range(patches // CHUNK):
        depth = depths(random.standard_normal((count, CHUNK)))
        for place, one in enumerate(c):
            places = np.rint(np.log(pulls(depth, one)) / BIN).astype(int)
            result[number % PARTS, place] += np.bincount(places, minlength=bins)
    return result


class Audit:
    """Data of a scene and their posterior."""

    def __init__(self, count, modulus, truth, priors, number, error, patches, *, random):
        self.count, self.modulus, self.truth, self.priors, self.error, self.simulated = count, modulus, truth, priors, error, patches
        self.random = random
        log_pull, log_c = self.similarity({key: np.log(value) for key, value in truth.items()})
        forces = np.exp(log_pull) * pulls(depths(random.standard_normal((count, number))), np.exp(log_c))
        self.forces = np.array([float(f"{force:.6g}") for force in forces + error * random.standard_normal(number)])

    def similarity(self, logs):
        """ln A and ln c by the logarithms of Δγ, R and σ_s."""
        log_pull = np.log(2 * np.pi) + logs[RADIUS] + logs[ENERGY]
        log_c = np.log(2 * self.modulus / (3 * np.pi)) + 1.5 * logs[HEIGHTS] - 0.5 * logs[RADIUS] - logs[ENERGY]
        return log_pull, log_c

    def parameters(self, log_pull, log_c):
        """Logarithms of the parameters with priors at ln A, (c, A), and ln c, (c, 1): the solution of `similarity`, which is linear."""
        logs = {key: np.log(value) for key, value in self.truth.items()}
        at = [value - zero for value, zero in zip((log_pull, log_c), self.similarity(logs), strict=True)]
        columns = []
        for key in self.priors:
            moved = self.similarity({**logs, key: logs[key] + 1.0})
            columns.append(np.subtract(moved, self.similarity(logs)))
        if len(columns) == 1:
            return {ENERGY: logs[ENERGY] + at[0]}
        inverse = np.linalg.inv(np.array(columns).T)
        return {key: logs[key] + row[0] * at[0] + row[1] * at[1] for key, row in zip(self.priors, inverse, strict=True)}

    def log_prior(self, logs):
        """ln of the prior's density over the logarithms, without constants."""
        result = 0.0
        for key, prior in self.priors.items():
            if prior["prior"] == "log_uniform":
                within = (logs[key] >= np.log(prior["from"])) & (logs[key] <= np.log(prior["to"]))
                result = result + np.where(within, 0.0, -np.inf)
            else:
                result = result - 0.5 * ((logs[key] - np.log(prior["median"])) / prior["log_std"]) ** 2
        return result

    def whole(self):
        """Ends of ln c and ln A over the prior, log-normal laws to five standard deviations."""
        ends = {key: [np.log(value)] for key, value in self.truth.items()}
        for key, prior in self.priors.items():
            if prior["prior"] == "log_uniform":
                ends[key] = np.log([prior["from"], prior["to"]])
            else:
                ends[key] = np.log(prior["median"]) + np.array([-5.0, 5.0]) * prior["log_std"]
        corners = [dict(zip(ends, corner, strict=True)) for corner in np.stack(np.meshgrid(*ends.values()), -1).reshape(-1, 3)]
        both = np.array([self.similarity(corner) for corner in corners])
        return (both[:, 1].min(), both[:, 1].max()), (both[:, 0].min(), both[:, 0].max())

    def log_likelihood(self, table, log_pull, width):
        """ln of the likelihood by counts, (c, bins), at ln A, (c, A)."""
        y = BIN * np.arange(table.shape[1])
        result = np.empty(log_pull.shape)
        if self.error:
            share = table / table.sum(axis=1, keepdims=True)
            for k in range(log_pull.shape[1]):
                # ln A is one for all c: several priors.
                deviation = (self.forces[:, None] - np.exp(log_pull[0, k] + y)) / self.error
                result[:, k] = np.log(np.exp(-0.5 * deviation**2) @ share.T + 1e-300).sum(axis=0)
            return result
        for place, row in enumerate(table):
            smooth = gaussian_filter1d(row, width / BIN, mode="constant")
            smooth -= 0.5 * (width / BIN) ** 2 * gaussian_filter1d(row, width / BIN, order=2, mode="constant")
            log_density = np.log(np.maximum(smooth / row.sum(), 1e-12))
            at = np.log(self.forces) - log_pull[place, :, None]
            result[place] = np.interp(at, y, log_density, left=np.log(1e-12), right=np.log(1e-12)).sum(axis=1)
        return result

    def grid(self, c_ends, pull_ends, nodes):
        """ln c, (c,), and ln A, (c, A), of the nodes; with one prior there is one ln A for each c."""
        log_c = np.linspace(*c_ends, nodes[0])
        if len(self.priors) == 1:
            log_pull, own = self.similarity({key: np.log(value) for key, value in self.truth.items()})
            return log_c, (log_pull + own - log_c)[:, None]
        return log_c, np.tile(np.linspace(*pull_ends, nodes[1]), (nodes[0], 1))

    def weights(self, likelihood, log_c, log_pull):
        """Probabilities of nodes and the logarithms of the parameters there, eight nodes in the place of each c."""
        fine = np.linspace(log_c[0], log_c[-1], 8 * (len(log_c) - 1) + 1)
        pull = CubicSpline(log_c, log_pull)(fine)
        logs = self.parameters(pull, fine[:, None])
        posterior = CubicSpline(log_c, likelihood)(fine) + self.log_prior(logs)
        weights = np.exp(posterior - logsumexp(posterior))
        return weights, logs, (fine[:, None], pull)

    def posterior(self):
        """Figures of each parameter."""
        log_c, log_pull = self.grid(*self.whole(), (121, 801))
        table = counts(self.random, COARSE, self.count, np.exp(log_c)).sum(axis=0)
        ends = self.ends(*self.weights(self.log_likelihood(table, log_pull, WIDTH), log_c, log_pull))
        log_c, log_pull = self.grid(*ends, (33, 201))
        parts = counts(self.random, self.simulated, self.count, np.exp(log_c))
        assert self.error or np.log(self.forces.min()) - log_pull.max() > 5 * WIDTH, "a force is where one asperity decides"

        def of(table, width=WIDTH, step=1):
            at = slice(None, None, step)
            weights, logs, _ = self.weights(self.log_likelihood(table[at], log_pull[at], width), log_c[at], log_pull[at])
            return {key: figures(weights, np.broadcast_to(np.exp(value), weights.shape)) for key, value in logs.items()}

        weights = self.weights(self.log_likelihood(parts.sum(axis=0), log_pull, WIDTH), log_c, log_pull)[0]
        rim = weights[[0, -1]].sum() + (weights[:, [0, -1]].sum() if len(self.priors) > 1 else 0.0)
        assert rim < 1e-6, "the grid cuts the posterior"
        whole, each = of(parts.sum(axis=0)), [of(part) for part in parts]
        changed = [of(parts.sum(axis=0), WIDTH / 2), of(parts.sum(axis=0), step=2)]
        for key, found in whole.items():
            means = np.array([one[key]["mean"] for one in each])
            found["mean_error"] = float(means.std(ddof=1) / PARTS**0.5 / found["std"])
            # The logarithm of an estimate is off by its variance, of a part by eight times as much.
            found["mean_bias"] = float((means.mean() - found["mean"]) / (PARTS - 1) / found["std"])
            found["std_error"] = float(np.std([one[key]["std"] for one in each], ddof=1) / PARTS**0.5 / found["std"])
            found["halved_width"], found["halved_grid"] = (float((one[key]["mean"] - found["mean"]) / found["std"]) for one in changed)
            print(key, found, flush=True)
            assert max(abs(found[name]) for name in ("mean_error", "mean_bias", "halved_width", "halved_grid")) < MOST
        return whole

    def ends(self, weights, _, places):
        """Ends of ln c and ln A seven standard deviations of a posterior away from its mean, within the prior."""
        result = []
        for value, (low, high) in zip(places, self.whole(), strict=True):
            value = np.broadcast_to(value, weights.shape)
            mean = (weights * value).sum()
            std = max((weights * (value - mean) ** 2).sum() ** 0.5, 1e-3)
            result.append((max(mean - 7.0 * std, low), min(mean + 7.0 * std, high)))
        return result

    def patches_of(self, random):
        """Heights of some patches over σ_s, a row for each, and their forces at the true parameters."""
        heights = np.array([[float(f"{height:.4f}") for height in row] for row in random.standard_normal((self.count, 5))])
        log_pull, log_c = self.similarity({key: np.log(value) for key, value in self.truth.items()})
        return {"heights": heights.T.tolist(), "forces": (np.exp(log_pull) * pulls(depths(heights), np.exp(log_c))).tolist()}

    def scene(self):
        """The tables of the scene, as the program reads them."""
        given = {key: f"{value:g} {UNITS[key]}" for key, value in self.truth.items()}
        for key, prior in self.priors.items():
            given[key] = {name: f"{value:g} {UNITS[key]}" if name in ("from", "to", "median") else value for name, value in prior.items()}
        surface = {"asperity_density": "10 /um^2", "nominal_area": f"{self.count / 10:g} um^2", "mean_plane_offset": "0 nm"}
        return {
            "format": 1,
            "material": {"reduced_modulus": f"{self.modulus / 1e9:g} GPa", "work_of_adhesion": given[ENERGY]},
            "surface": {**surface, "asperity_radius": given[RADIUS], "asperity_height_std": given[HEIGHTS]},
            "model": {"law": "dmt", "history": "approach"},
            "separation": {"h_star": {"from": -5.0, "to": 6.0, "count": 111}},
        }


def figures(weights, values):
    """Mean, standard deviation and quantiles of a parameter."""
    order = np.argsort(values, axis=None)
    values, weights = values.ravel()[order], weights.ravel()[order]
    mean = float(weights @ values)
    below = np.cumsum(weights) - 0.5 * weights
    quantiles = {name: float(np.interp(share, below, values)) for name, share in QUANTILES.items()}
    return {"mean": mean, "std": float((weights @ (values - mean) ** 2) ** 0.5), **quantiles}


def content():
    """All audits, as the file has them."""
    result = {}
    for number, (name, setting) in enumerate(AUDITS.items()):
        print(name, flush=True)
        audit = Audit(*setting, random=np.random.default_rng([2040, number]))
        posterior = {key: {of: float(f"{value:.6g}") for of, value in found.items()} for key, found in audit.posterior().items()}
        result[name] = {
            "scene": audit.scene(), "truth": {key: f"{value:g} {UNITS[key]}" for key, value in audit.truth.items()},
            "patches": audit.patches_of(np.random.default_rng([2041, number])), "posterior": posterior, "error": audit.error, "forces": audit.forces.tolist(),
        }  # fmt: skip
    return result


if __name__ == "__main__":
    write_json("posteriors.json", content())
