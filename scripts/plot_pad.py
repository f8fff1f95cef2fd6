"""Will a pad stick? Its pull-off after a preload, and the probability that it holds against a restoring force.

Usage: python scripts/plot_pad.py [-o OUT.svg]      runs the template mems-pad of `stiction new`, half a minute

(a) quantiles of the pull-off over the preload: 5, 50 and 95 % of pads, with their 95 % intervals;
(b) probability that a pad pulls harder than the restoring force, with its 95 % interval (Clopper and
    Pearson). The table is printed.
"""

import tempfile
from pathlib import Path

import h5py
from drawing import BLUE, DOCS, VERMILION, Figure, context, options, panel, run

RESTORING = 80  # nN
PRELOADS = (10, 15, 22, 33, 47, 68, 100, 150, 220, 330, 470, 680, 1000)  # uN
REPLICAS = 400


def draw(preloads, quantiles, intervals, probability, low, high):
    figure = Figure(figsize=(4.2, 4.8), layout="none")
    pulls, shares = panel(figure, 0.62, 2.8, 3.4, 1.75), panel(figure, 0.62, 0.45, 3.4, 1.75)
    styles = {0.05: ("v", "5 %"), 0.5: ("o", "median"), 0.95: ("^", "95 %")}
    for (marker, label), values, ends in zip(styles.values(), quantiles, intervals, strict=True):
        errors = [values - ends[:, 0], ends[:, 1] - values]
        pulls.errorbar(preloads, values, errors, marker=marker, color=BLUE, linewidth=0.8, label=label)
    pulls.fill_between(preloads, quantiles[0], quantiles[-1], color=BLUE, alpha=0.12, linewidth=0)
    pulls.axhline(RESTORING, color=VERMILION, linestyle="dotted", label="restoring force")
    pulls.set(xscale="log", ylabel="pull-off (nN)", ylim=(0, None), title="(a)")
    pulls.legend(loc="upper left")
    shares.errorbar(preloads, probability, [probability - low, high - probability], marker="o", color=BLUE,
                    linewidth=0.8)
    shares.set(xscale="log", xlabel="preload (µN)", ylabel=f"probability to hold {RESTORING} nN", ylim=(0, 1.05),
               title="(b)")
    return figure


def main():
    arguments = options(__doc__, DOCS / "pad.svg").parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scene, output = Path(folder, "pad.toml"), Path(folder, "pad.h5")
        run("new", scene, "--template", "mems-pad")
        values = ", ".join(f'"{preload} uN"' for preload in PRELOADS)
        run("run", scene, "--set", f"instability.preload=[{values}]", "--above", f"{RESTORING} nN",
            "--replicas", REPLICAS, "--quiet", "-o", output)
        with h5py.File(output) as file:
            own, device = file["instability"], file["device"]
            wanted = [list(own["pull_off_quantile"][:].round(6)).index(share) for share in (0.05, 0.5, 0.95)]
            quantiles = 1e9 * own["pull_off_after_preload_quantile"][:].T[wanted]
            ends = 1e9 * own["pull_off_after_preload_quantile_interval"][:].transpose(1, 0, 2)[wanted]
            chances = [device[f"stuck_probability{end}_after_preload"][:] for end in ("", "_low", "_high")]
    print("preload (uN), pull-off of 5, 50, 95 % (nN), probability, its interval")
    print("\n".join(" ".join(f"{value:8.4g}" for value in row)
                    for row in zip(PRELOADS, *quantiles, *chances, strict=True)))
    with context():
        draw(PRELOADS, quantiles, ends, *chances).savefig(arguments.output, dpi=arguments.dpi)


if __name__ == "__main__":
    main()
