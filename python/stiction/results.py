"""What files of results contain: thin layers over the `xarray.DataTree` of a file. Figures of them are above, in `opened`."""

from __future__ import annotations

import math
import re
import shutil
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self

import h5py
import numpy as np
import pandas as pd
import xarray

from . import files, quantities, stored
from .errors import FileError, SceneError

__all__ = ["OF_WHOLE_LOOP", "Asperities", "CrossCheck", "Finding", "Format", "PullOff", "Result", "Run", "Sweep", "agreement", "format_of", "indexed", "is_preload", "is_result"]

# Numbers of replicas that are of the whole loop, where they may be taken for the ones after a preload.
OF_WHOLE_LOOP = ("pull_off_force", "pull_off_separation")


def agreement(replicas: int, most_differing: float) -> str:
    """The statement where all replicas agree; most_differing is the fraction of patches that differ at most."""
    share = quantities.number(100.0 * most_differing)
    return f"all {replicas} replicas agree: with 95 % confidence at most {share} % of patches differ"


def is_preload(known: xarray.DataArray, given: Any) -> xarray.DataArray:
    """Which of the preloads of a scene, N, are the one that is given, a text such as ``"100 uN"`` or N.

    Raises
    ------
    SceneError
        None is.
    """
    try:
        wanted = float(quantities.in_si("preload", given, "N"))
    except ValueError as error:
        raise SceneError(str(error)) from None
    found = xarray.zeros_like(known, dtype=bool) + np.isclose(known, wanted, rtol=1e-9, atol=0.0)
    if not found.any():
        loads = np.unique(known.values[np.isfinite(known.values)])
        has = ", ".join(quantities.si(load, "N") for load in loads) or "none"
        raise SceneError(f"preload = {given}: the file has {has}; name one of them, or run with it in [instability]")
    return found


@dataclass(frozen=True)
class PullOff:
    """The pull-off force that is to be quoted: the mean over replicas.

    Attributes
    ----------
    mean_over_patches, standard_error : float
        The mean over replicas and its standard error, N; with the integral as control variate where that was possible.
        The error is NaN for one replica, and where all replicas agree.
    interval : tuple of float
        Interval that contains the true mean with the probability `interval_level`, N.
    std, scatter : float
        Standard deviation from patch to patch, N, and over the plain mean of the replicas.
    separation : float
        Mean separation of the pull-off of replicas, m.
    of_mean_curve, of_integral : float
        Depth of the mean curve, and of the statistical integral, N: smaller, as each patch has its own separation.
    replicas : int
        How many replicas it is the mean of.
    most_differing : float or None
        Where all replicas agree, the fraction of patches that differ at most, with 95 % confidence; otherwise None.
    preload : float or None
        The preload before the pull-off, N: the largest that is reached, where the scene has preloads. Mean curve and
        integral then refer to the whole loop.
    """

    mean_over_patches: float
    standard_error: float
    interval: tuple[float, float]
    interval_level: float
    std: float
    scatter: float
    separation: float
    of_mean_curve: float
    of_integral: float
    replicas: int
    most_differing: float | None = None
    preload: float | None = None

    def __str__(self) -> str:
        return quantities.with_error(self.mean_over_patches, self.standard_error, "N")

    @property
    def agreement(self) -> str:
        """The statement where all replicas agree; empty where they do not."""
        if self.most_differing is None:
            return ""
        return agreement(self.replicas, self.most_differing)

    def __float__(self) -> float:
        return self.mean_over_patches


@dataclass(frozen=True)
class CrossCheck:
    """The joint test of the ensemble against the integral.

    Attributes
    ----------
    verdict : str
        ``agree``, ``disagree`` or ``not tested``.
    p_value, statistic, degrees_of_freedom, significance : float
        χ², its degrees of freedom and the probability of a larger one; NaN when not tested.
    """

    verdict: str
    p_value: float
    statistic: float
    degrees_of_freedom: float
    significance: float

    def __str__(self) -> str:
        if np.isnan(self.p_value):
            return self.verdict
        return f"{self.verdict} at the {100 * self.significance:g} % level, p = {self.p_value:.3g}"


@dataclass(frozen=True)
class Format:
    """A format of result files: its kind, the command that makes them, and the major version that this package reads."""

    kind: str
    made_by: str
    major_version: int = 1


class Result:
    """The contents of a result file."""

    #: The formats of such files by their root attribute `format`.
    formats: ClassVar[Mapping[str, Format]] = {}
    #: Groups that all such files have.
    groups: ClassVar[tuple[str, ...]] = ()

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        #: The folder of a file without a name, which is deleted with the result.
        self.folder: files.Folder | None = None
        self.format = FORMATS[format_of(self.path, type(self))]
        stored.check(self.path)
        with stored.reading(self.path):
            opened = xarray.open_datatree(self.path, engine="h5netcdf", decode_times=False)
            self.tree = opened.map_over_datasets(indexed)
        self.tree.set_close(opened.close)
        missing = [name for name in self.groups if name not in self.tree.children]
        if missing:
            self.close()
            raise FileError(f"{self.path}: is damaged or not whole: no group /{missing[0]}")

    @property
    def attrs(self) -> dict[str, Any]:
        """The attributes of the whole file."""
        return {str(name): value for name, value in self.tree.attrs.items()}

    @property
    def title(self) -> str:
        """The title of the scene, or "" without one."""
        return str(self.tree.attrs.get("title", ""))

    @property
    def scene_text(self) -> str:
        """The scene as it was run, TOML."""
        return str(self.tree.attrs.get("scene", ""))

    @cached_property
    def scene(self) -> dict[str, Any]:
        """The tables of the scene as it was run."""
        return tomllib.loads(self.scene_text)

    @property
    def warnings(self) -> list[str]:
        """Warnings of the program, a text each."""
        return [line for line in str(self.tree.attrs.get("warnings", "")).splitlines() if line]

    @property
    def left_out(self) -> str:
        """Asperities beyond the end of the law, and where, as the warnings name them; "" where the law leaves out none."""
        found = (re.search(r"leaves out (.+)", warning) for warning in self.warnings)
        return next((match[1] for match in found if match), "")

    @property
    def is_partial(self) -> bool:
        """Whether replicas of the run are missing: in a shard, an interrupted run, or a merge without some shards."""
        return "partial" in self.tree.attrs

    def __getitem__(self, path: str) -> Any:
        """A group (`xarray.DataTree`) or dataset (`xarray.DataArray`) by its path in the file."""
        return self.tree[path]

    def __contains__(self, path: str) -> bool:
        node: Any = self.tree
        for name in path.strip("/").split("/"):
            if not (isinstance(node, xarray.DataTree) and (name in node.children or name in node.variables)):
                return False
            node = node[name]
        return True

    def group(self, name: str) -> xarray.Dataset:
        """A group as a separate dataset; a group that the file does not have is an error.

        Raises
        ------
        FileError
            The file has no such group.
        """
        if name not in self.tree.children:
            known = ", ".join(self.tree.children)
            raise FileError(f"{self.path}: no group /{name}; it has {known}")
        return self.tree.children[name].to_dataset()

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Copies the file to `path`.

        Raises
        ------
        FileError
            There is a file already and `force` is false, or it is the file of the result itself.
        """
        with files.writing(path, force=force, inputs=[self.path]) as part:
            shutil.copyfile(self.path, part)
        return Path(path)

    def close(self) -> None:
        """Closes the file."""
        self.tree.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _summary(self) -> list[tuple[str, str]]:
        """Names and values of the lines that `repr` shows."""
        return []

    def __repr__(self) -> str:
        lines = [f"<stiction.{type(self).__name__} {self.title or self.path.name!r}>"]
        lines += [f"  {name:<18}{value}" for name, value in self._summary()]
        lines += [f"  {'warning':<18}{text}" for text in self.warnings]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        from html import escape

        rows = self._summary() + [("warning", text) for text in self.warnings]
        cells = "".join(
            f"<tr><th style='text-align:left'>{escape(name)}</th><td style='text-align:left'>{escape(value)}</td></tr>"
            for name, value in rows
        )
        return f"<table><caption>{escape(self.title or self.path.name)}</caption>{cells}</table>"


class _Curves(Result):
    """A result with an ensemble and an integral."""

    groups = ("integral", "diagnostics")

    @property
    def has_replicas(self) -> bool:
        """Whether there are replicas, and not the integral alone."""
        return "ensemble" in self.tree.children

    @cached_property
    def ensemble(self) -> xarray.Dataset:
        """Means over replicas, over `separation` (m) and `h_star`, both of which select."""
        return self.group("ensemble")

    @cached_property
    def integral(self) -> xarray.Dataset:
        """The statistical integral, over `separation` (m) and `h_star`."""
        return self.group("integral")

    @cached_property
    def validation(self) -> xarray.Dataset:
        """Ensemble against integral: z-scores over `separation`, and what the joint test looks at."""
        return self.group("validation")

    @cached_property
    def independence(self) -> xarray.Dataset:
        """Numbers that say whether asperities may be taken as independent, with the attribute or variable `verdict`."""
        return self.group("independence")

    @cached_property
    def replicas(self) -> xarray.Dataset:
        """Numbers of each replica: a row each in ``replicas.to_dataframe()``.

        A row for each replica and point of a sweep. Where the scene has preloads, a variable of each is named by it, such as
        ``pull_off_after_preload[0.0001 N]`` (N), and `pull_off_force` (N) and `pull_off_separation` (m), which are of the whole
        loop, end in ``_of_whole_loop``. Variables that have another dimension besides are left out; curves are in `curves`.
        """
        whole = self.group("replicas")
        if self.has_preload:
            names = {name: f"{name}_of_whole_loop" for name in OF_WHOLE_LOOP}
            whole = whole.rename(names).assign(self._of_preloads(whole))
        points = set(self.tree.dims)
        rows = [name for name, value in whole.data_vars.items() if set(value.dims) - points == {"replica"}]
        table = whole[rows]
        return table.drop_vars(
            [name for name, value in table.coords.items() if set(value.dims) - points - {"replica"}]
        )

    @property
    def has_preload(self) -> bool:
        """Whether the scene has preloads. Without them numbers after a turn are of the whole loop."""
        return "instability/preload" in self and bool(self.group("instability")["preload"].notnull().any())

    def _of_preloads(self, whole: xarray.Dataset) -> dict[str, xarray.DataArray]:
        """The numbers of replicas after each preload by name and preload."""
        points = set(self.tree.dims)
        after = {name: value for name, value in whole.data_vars.items() if set(value.dims) - points == {"replica", "preload"}}
        preloads = self.group("instability")["preload"].values
        return {
            f"{name}[{repr(preload).replace('e-0', 'e-')} N]": value.isel(preload=i)
            for name, value in after.items() for i, preload in enumerate(preloads.tolist()) if np.isfinite(preload)
        }  # fmt: skip

    @property
    def preloads(self) -> list[float]:
        """The preloads of the scene, N, in its order; none where pull-offs are of the whole history."""
        if not (self.has_preload and self.has_replicas):
            return []
        known = self.group("instability")["preload"].values
        return [float(load) for load in dict.fromkeys(known[np.isfinite(known)])]

    def stuck_after(self, preload: Any = None) -> xarray.Dataset:
        """Probability that the pull-off exceeds the restoring force of the device.

        Parameters
        ----------
        preload : str or float, optional
            As of `after_preload`.

        Returns
        -------
        xarray.Dataset
            `stuck_probability`, and `stuck_probability_low` and `stuck_probability_high`, the ends of its 95 % interval; of a sweep at each point.

        Raises
        ------
        FileError
            The scene has no ``[device]``, or no replicas.
        SceneError
            The scene has no such preload.
        """
        if "device" not in self or not self.has_replicas:
            raise FileError(f"{self.path}: has no probability of a device; run with `--above`, or with [device] in the scene")
        pressed = self.after_preload(preload)
        of = self.group("device") if pressed is None else pressed
        return of[[f"stuck_probability{end}" for end in ("", "_low", "_high")]]

    @property
    def restoring_force(self) -> float | None:
        """The restoring force of the device, N; None without one, and where the points of a sweep differ in it."""
        forces = np.unique(self["device/restoring_force"].values) if "device" in self else np.zeros(0)
        return float(forces[0]) if forces.size == 1 else None

    def _stuck(self) -> list[tuple[str, str]]:
        """The lines of a device: probabilities with their intervals, of a sweep the smallest and the largest of its points."""
        if "device" not in self or not self.has_replicas:
            return []
        force = self.restoring_force
        label = "stuck" if force is None else f"above {quantities.si(force, 'N')}"
        rows = []
        loads: list[float | None] = [*self.preloads]
        for preload in loads or [None]:
            of = self.stuck_after(preload)
            low, share, high = (100.0 * np.ravel(of[f"stuck_probability{end}"].values) for end in ("_low", "", "_high"))
            after = "" if preload is None else f" after {quantities.si(preload, 'N')}"
            if np.isnan(share).all():
                text = "no replica reaches the preload"
            elif share.size == 1:
                text = f"P = {share[0]:.4g} % ({low[0]:.4g} to {high[0]:.4g} %)"
            else:
                text = f"P = {np.nanmin(share):.4g} to {np.nanmax(share):.4g} %"
            rows.append((label, text + after))
            label = ""
        return rows

    @cached_property
    def after_largest_preload(self) -> xarray.Dataset | None:
        """Pull-off after the largest preload that replicas reach; see `after_preload`."""
        return self._pulled(None)

    def after_preload(self, preload: Any = None) -> xarray.Dataset | None:
        """Pull-off after a preload, of a sweep at each point; None for a scene without preloads or without replicas.

        Parameters
        ----------
        preload : str or float, optional
            One of the scene, a text such as ``"100 uN"`` or N; by default the largest that replicas reach.

        Returns
        -------
        xarray.Dataset or None
            `mean_over_patches`, `standard_error`, `interval` (95 %, over `range_end`) and `std` of the force, N; `separation`, m; `count`, the
            replicas that reach it; `preload`, N; of a scene with ``[device]`` `stuck_probability` and the ends of its interval. All are NaN
            where no replica reaches the preload.

        Raises
        ------
        SceneError
            The scene has no such preload.
        """
        return self.after_largest_preload if preload is None else self._pulled(preload)

    def _pulled(self, preload: Any) -> xarray.Dataset | None:
        """As `after_preload`, computed anew."""
        if not self.has_preload or not self.has_replicas:
            if preload is not None:
                is_preload(xarray.DataArray([np.nan]), preload)
            return None
        group, of = self.group("instability"), self._after(preload)
        names = {"mean_over_patches": "mean", "standard_error": "standard_error", "interval": "interval", "std": "std"}
        found = {name: of(group[f"pull_off_after_preload_{own}"]) for name, own in names.items()}
        found["count"] = of(group["preload_reached_count"])
        found["separation"] = of(self.group("replicas")["pull_off_after_preload_separation"].mean("replica"))
        found["preload"] = of(group["preload"].reset_coords(drop=True))
        if "device" in self:
            device = self.group("device")
            for name in ("stuck_probability", "stuck_probability_low", "stuck_probability_high"):
                found[name] = of(device[f"{name}_after_preload"])
        return xarray.Dataset(found)

    def _after(self, preload: Any) -> Callable[[xarray.DataArray], xarray.DataArray]:
        """What takes values after a preload, by default the largest that replicas reach; they are NaN where replicas do not reach it."""
        known = self.group("instability")["preload"]
        chosen = known.notnull() if preload is None else is_preload(known, preload)
        reached = chosen & (self.group("instability")["preload_reached_count"] > 0)
        place, is_reached = known.where(reached, -np.inf).argmax("preload"), reached.any("preload")
        return lambda array: array.isel(preload=place).where(is_reached).drop_vars("preload", errors="ignore")

    @cached_property
    def model_range(self) -> xarray.Dataset | None:
        """Results by every plastic contact after the largest preload that replicas reach; see `model_range_after`."""
        return self.model_range_after()

    def model_range_after(self, preload: Any = None) -> xarray.Dataset | None:
        """Results by every plastic contact, over `plastic_contact`: the error of the model. None where no contacts yield, or it was left out.

        Parameters
        ----------
        preload : str or float, optional
            As of `after_preload`.

        Returns
        -------
        xarray.Dataset or None
            `pull_off_force`, N; of a scene with ``[device]`` `stuck_probability`; of a loop `dissipated_energy`, J; `replica_count`, the
            replicas of every contact but the scene's own. Where there are preloads, force and probability follow the preload, and are not
            there if none is reached. Sweeps have them at each point.

        Raises
        ------
        SceneError
            The scene has no such preload.
        """
        if "model_range" not in self:
            return None
        group = self.group("model_range")
        found = {str(name): of for name, of in group.data_vars.items() if not str(name).endswith("_after_preload")}
        if self.has_preload and self.has_replicas:
            of = self._after(preload)
            for name, own in (("pull_off_force", "pull_off_after_preload"), ("stuck_probability", "stuck_probability_after_preload")):
                found.pop(name, None)
                if own in group:
                    found[name] = of(group[own])
        return xarray.Dataset(found)

    @cached_property
    def curves(self) -> xarray.Dataset:
        """Curves of each replica over `separation`, with ``curves = true`` in ``[output]``."""
        whole = self.group("replicas")
        return whole[[name for name, value in whole.data_vars.items() if value.ndim > 1]]


class Run(_Curves):
    """The contents of a run of one scene."""

    formats = {"stiction-run": Format("run", "stiction run", 3)}

    @cached_property
    def pull_off(self) -> PullOff:
        """The pull-off force that is to be quoted; of a loop on retraction, after the largest preload that is reached."""
        ensemble, replicas = self.group("ensemble"), self.group("replicas")
        of_loop = float(ensemble.attrs["pull_off_force"]), float(self.tree["integral"].attrs["pull_off_force"])
        pressed = self.after_largest_preload
        if pressed is not None:
            number = {str(name): float(of) for name, of in pressed.data_vars.items() if not of.dims}
            low, high = (float(value) for value in pressed["interval"].values)
            return PullOff(
                mean_over_patches=number["mean_over_patches"], standard_error=number["standard_error"], interval=(low, high),
                interval_level=float(ensemble.attrs["interval_level"]), std=number["std"],
                scatter=number["std"] / number["mean_over_patches"] if number["mean_over_patches"] > 0.0 else float("nan"),
                separation=number["separation"], of_mean_curve=of_loop[0], of_integral=of_loop[1],
                replicas=int(np.nan_to_num(number["count"])), preload=number["preload"],
            )  # fmt: skip
        force = ensemble.sel(scalar="pull_off_force")
        values = replicas["pull_off_force"].values
        low, high = (float(value) for value in force["scalar_controlled_interval"].values)
        std = float(values.std(ddof=1)) if values.size > 1 else float("nan")
        differing = float(force["scalar_most_differing"])
        return PullOff(
            mean_over_patches=float(force["scalar_controlled_mean"]),
            standard_error=float(force["scalar_controlled_standard_error"]),
            interval=(low, high),
            interval_level=float(ensemble.attrs["interval_level"]),
            std=std,
            scatter=std / float(values.mean()) if values.mean() > 0.0 else float("nan"),
            separation=float(replicas["pull_off_separation"].mean()),
            of_mean_curve=of_loop[0],
            of_integral=of_loop[1],
            replicas=int(values.size),
            most_differing=differing if differing > 0.0 else None,
        )

    @cached_property
    def mean_plane_forces(self) -> dict[str, str]:
        """Datasets of the forces between the mean planes, N over the separations, by the name of each force."""
        of_group = self.tree["background"] if "background" in self else ()
        names = [str(name) for name in of_group if str(name).endswith("_force")]
        words = (name.removesuffix("_force").replace("_", " ").replace("waals", "Waals") for name in names)
        return dict(zip(words, (f"background/{name}" for name in names), strict=True))

    @cached_property
    def cross_check(self) -> CrossCheck:
        """The joint test of the ensemble against the integral."""
        attrs = self.tree["validation"].attrs
        names = ("p_value", "statistic", "degrees_of_freedom", "significance")
        return CrossCheck(str(attrs["verdict"]), *(float(attrs[name]) for name in names))

    def _after_preloads(self) -> list[tuple[str, str]]:
        """The pull-off after each preload that is reached, in words."""
        if "instability/preload" not in self:
            return []
        group = self.group("instability")
        names = ("mean", "std")
        means, stds = (group[f"pull_off_after_preload_{name}"].values for name in names)
        counts = group["preload_reached_count"].values
        rows = []
        for load, mean, std, count in zip(group["preload"].values, means, stds, counts, strict=True):
            if np.isfinite(load) and count > 0:
                value = quantities.with_error(mean, std / math.sqrt(count), "N")
                rows += [("pull-off", f"{value} after {quantities.si(load, 'N')}, mean over {quantities.counted(int(count), 'replica')}")]
        return rows

    def _dissipated(self) -> list[tuple[str, str]]:
        """The energy that a cycle of a loop dissipates."""
        of = self.tree["ensemble"].to_dataset()
        if "dissipated_energy" not in of["scalar"].values:
            return []
        mean, error = (float(of[name].sel(scalar="dissipated_energy")) for name in ("scalar_mean", "scalar_standard_error"))
        cycle = "a cycle" if self.pull_off.preload is None else "a cycle over all separations"
        count = quantities.counted(int(self.attrs["replicas"]), "replica")
        return [("dissipated", f"{quantities.with_error(mean, error, 'J')} in {cycle}, mean over {count}")]

    def _summary(self) -> list[tuple[str, str]]:
        if not self.has_replicas:
            force = float(self.tree["integral"].attrs["pull_off_force"])
            text = f"{quantities.si(force, 'N')}, of the integral alone" if force > 0.0 else "none: nothing pulls"
            return [("law", f"{self.attrs['law']}, {self.attrs['history']}"), ("pull-off", text)]
        pull_off, sigma = self.pull_off, float(self.attrs["surface_height_std"])
        low, high = (quantities.si(value, "N") for value in pull_off.interval)
        rows = [("law", f"{self.attrs['law']}, {self.attrs['history']}")]
        after = self._after_preloads()
        if after:
            rows += after
        elif pull_off.mean_over_patches > 0.0 and pull_off.replicas == 1:
            rows += [("pull-off", f"{pull_off}, of one replica")]
        elif pull_off.mean_over_patches > 0.0:
            rows += [
                ("pull-off", f"{pull_off}, mean over {pull_off.replicas} replicas"),
                ("interval", f"{low} to {high} ({100 * pull_off.interval_level:g} %)"),
                (
                    "std",
                    f"{100 * pull_off.scatter:.4g} % from patch to patch, at h* = {pull_off.separation / sigma:.3f} on average",
                ),
            ]
        else:
            rows += [("pull-off", "none: no replica pulls")]
        if self.model_range is not None and "pull_off_force" in self.model_range:
            ends = [float(getattr(self.model_range["pull_off_force"], end)()) for end in ("min", "max")]
            pressed = "" if pull_off.preload is None else f" after {quantities.si(pull_off.preload, 'N')}"
            rows += [("model range", f"{' to '.join(quantities.si(end, 'N') for end in ends)}{pressed}, by plastic contact")]
        rows += [*self._stuck(), *self._dissipated(), ("cross-check", str(self.cross_check))]
        rows += [("independence", str(self.independence.attrs["verdict"]))]
        if self.is_partial:
            rows += [
                ("partial", f"{self.attrs['replicas']} of {self.attrs['replicas_of_whole_run']} replicas")
            ]
        return rows


class Sweep(_Curves):
    """The contents of a sweep, or of a comparison of laws."""

    formats = {"stiction-sweep": Format("sweep", "stiction run of a scene with [sweep]", 4)}

    @property
    def keys(self) -> list[str]:
        """The keys of the scene that are swept, as the scene writes them."""
        return str(self.tree.attrs["sweep_keys"]).replace(",", " ").split()

    def key_text(self, key: str, value: Any, digits: int = 4) -> str:
        """A value of a key as people write it: its name if it is a choice, else a number with a unit."""
        unit = str(self.tree[key.replace(".", "_")].attrs.get("units", "1"))
        return value if isinstance(value, str) else quantities.si(value, unit, digits)

    @cached_property
    def points(self) -> xarray.Dataset:
        """Numbers of the points: the dimensions are the keys of the sweep."""
        return self.tree.to_dataset(inherit=False)

    @cached_property
    def pull_off(self) -> xarray.Dataset:
        """The pull-off force of each point: `mean_over_patches`, `standard_error`, `interval` and `of_integral`, N.

        Without replicas there is `of_integral` alone. Where the scene has preloads the pull-off follows the largest that is
        reached, `preload`, and `of_integral` is that of the whole loop.
        """
        if not self.has_replicas:
            return xarray.Dataset({"of_integral": self.tree["integral"]["pull_off_force"]})
        names = {"mean_over_patches": "mean", "standard_error": "standard_error", "interval": "interval"}
        pressed = self.after_largest_preload
        if pressed is not None:
            quoted = {name: pressed[name] for name in (*names, "preload")}
        else:
            force = self.group("ensemble").sel(scalar="pull_off_force")
            quoted = {name: force[f"scalar_controlled_{of}"] for name, of in names.items()}
        whole = xarray.Dataset({**quoted, "of_integral": self.tree["integral"]["pull_off_force"]})
        kept = set(self.tree.dims) | {"range_end"}
        return whole.drop_vars([name for name in whole.coords if name not in kept])

    def _summary(self) -> list[tuple[str, str]]:
        means = self.pull_off["mean_over_patches" if self.has_replicas else "of_integral"]
        low, high = (quantities.si(value, "N") for value in (means.min(), means.max()))
        shape = " x ".join(f"{size} of {name}" for name, size in self.points.sizes.items())
        laws = dict.fromkeys(self["model_law"].values if "model_law" in self else [self.attrs["law"]])
        rows = [
            ("law", f"{', '.join(laws)}, {self.attrs['history']}"),
            ("points", shape),
            ("pull-off", f"{low} to {high}{'' if self.has_replicas else ', of the integral alone'}"),
        ]
        if self.has_replicas:
            rows += [*self._stuck(), ("cross-check", str(self.tree["validation"].attrs["overall_verdict"]))]
        return rows


class Asperities(Result):
    """The contents of a file of asperities of a measured surface."""

    formats = {"stiction-asperities": Format("asperities", "stiction asperities", 2)}

    @cached_property
    def asperities(self) -> xarray.Dataset:
        """Height over the mean plane (m), radius (m), principal radii (m) and place (m) of each asperity."""
        return self.group("asperities")

    @property
    def height(self) -> Any:
        """Heights of the asperities above the mean plane of the surface, array (asperities,), m."""
        return self.asperities["height"].values

    @property
    def radius(self) -> Any:
        """Radii of the asperities, array (asperities,), m."""
        return self.asperities["radius"].values

    @cached_property
    def map(self) -> xarray.DataArray:
        """The levelled heights (m) in which they were found, dimensions `y` and `x` (m); NaN where pixels are missing."""
        return self.group("map")["height"]

    @cached_property
    def cutoffs(self) -> xarray.Dataset:
        """Number, density (1/m²), radius (m) and standard deviation of heights (m) of the summits over the dimension `cutoff` (m) of the filter.

        Raises
        ------
        FileError
            The file has none: it was made without `cutoffs`.
        """
        if "cutoffs" not in self:
            raise FileError(f"{self.path}: has no series over cut-offs; find_asperities(..., cutoffs=12) computes one")
        return self.group("cutoffs")

    def to_dataframe(self) -> pd.DataFrame:
        """A row for each asperity."""
        return self.asperities.to_dataframe()

    def _summary(self) -> list[tuple[str, str]]:
        def both(name: str, unit: str, factor: float = 1.0) -> str:
            """The number of the summits, and the one by moments."""
            of = [quantities.si(factor * float(self.tree[group][f"asperity_{name}"]), unit) for group in ("measured", "equivalent")]
            of = [f"{one} /µm²" for one in of] if name == "density" else of
            return f"{of[0]} of the summits, {of[1]} by moments"

        return [
            (
                "map",
                f"{self.attrs['map']}, {' x '.join(str(int(n)) for n in self.attrs['map_shape'])} pixels",
            ),
            ("asperities", str(self.asperities.sizes["asperity"])),
            ("density", both("density", "1", 1e-12)),
            ("1/mean curvature", both("radius", "m")),
            ("mean height", both("height_mean", "m")),
            ("height std", both("height_std", "m")),
        ]


class Finding(Result):
    """What `stiction infer`, `sensitivity`, `design` or `map` found, in words."""

    formats = {
        "stiction-inference": Format("inference", "stiction infer"),
        "stiction-calibration": Format("calibration", "stiction infer --calibrate"),
        "stiction-sensitivity": Format("sensitivity", "stiction sensitivity"),
        "stiction-design": Format("design", "stiction design"),
        "stiction-map": Format("map", "stiction map"),
    }

    @property
    def words(self) -> str:
        """What the command printed."""
        return str(self.attrs["summary"])

    def _summary(self) -> list[tuple[str, str]]:
        return [("", line) for line in self.words.splitlines()]


#: Formats of all results by their root attribute `format`.
FORMATS = {**Run.formats, **Sweep.formats, **Asperities.formats, **Finding.formats}


def format_of(path: Path, kind: type[Result] = Result) -> str:
    """The root attribute `format` of a file.

    Raises
    ------
    FileError
        There is no such file, it is no result of stiction, one of another kind, or of a version that this package does not read.
    """
    if not path.exists():
        raise FileError(f"{path}: no such file")
    if not path.is_file() or not h5py.is_hdf5(path):
        raise FileError(f"{path}: not an HDF5 file")
    stored.require_end(path)
    name, version = _format(path)
    known = FORMATS.get(name)
    if known is None:
        raise FileError(
            f"{path}: not a result of stiction: its attribute `format` is not one of {', '.join(FORMATS)}"
        )
    if kind.formats and name not in kind.formats:
        needed = next(iter(kind.formats.values()))
        raise FileError(f"{path}: a result of `{known.made_by}`, not of `{needed.made_by}`; open_run opens any")
    if version != known.major_version:
        raise FileError(
            f"{path}: its format version is {version}.x, this package reads {known.major_version}.x: "
            "make it again, or install the package of the version that made it"
        )
    return name


def _format(path: Path) -> tuple[str, int]:
    """The root attribute `format` of an HDF5 file, and the major version of it."""
    with stored.reading(path), h5py.File(path, "r") as file:
        found = file.attrs.get("format", "")
        version = int(np.atleast_1d(file.attrs.get("format_version", 0))[0])
    return found.decode() if isinstance(found, bytes) else str(found), version


def is_result(path: Path) -> bool:
    """Whether a file is a result of stiction of any kind, by its root attribute `format`."""
    return bool(h5py.is_hdf5(path)) and _format(path)[0] in FORMATS


def indexed(group: xarray.Dataset) -> xarray.Dataset:
    """A group to select from: by `h_star` and `asperity_separation`, where they are lists of their own, and by names of choices.

    Files have choices as numbers, and the names in words: ``what surrounds the surface: 0 none, 1 periodic``.
    """
    for key, of in group.variables.items():
        words, is_choice, names = str(of.attrs.get("long_name", "")).partition(": 0 ")
        if is_choice and "key" in of.attrs:
            known = dict(one.split(" ", 1) for one in f"0 {names}".split(", "))
            chosen = [known[f"{number:.0f}"] for number in of.values]
            group = group.assign_coords({key: (of.dims, chosen, {"key": of.attrs["key"], "long_name": words})})
    for name in ("h_star", "asperity_separation"):
        if name in group.coords and group[name].dims == ("separation",):
            group = group.set_xindex(name)
    return group
