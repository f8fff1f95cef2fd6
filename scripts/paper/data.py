"""Material of the figures and statements: runs of the program, and closed forms of one sphere."""

import csv
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from stiction import open_run

NM, UN = 1e-9, 1e-6
CASES = ("I", "II", "III")
ENERGIES = ("0.04", "0.09", "0.14")  # work of adhesion of figure 8, J/m^2


class PaperError(Exception):
    """The reason why the paper cannot be reproduced."""


class Comparison:
    """A file of `stiction compare`; by_law() gives the rows of one law."""

    def __init__(self, path):
        with open_run(path) as file:
            self.data = {f"{node.path[1:]}/{name}".lstrip("/"): values.values for node in file.tree.subtree
                         for name, values in node.variables.items()}
            material = file.scene["material"]
        self.laws, self.regimes = (list(self.data[name]) for name in ("model_law", "integral/regime"))
        # What follows from the scene is the same for every law.
        self.x, self.h, self.d = (self.data[f"integral/{name}"][0]
                                  for name in ("h_star", "separation", "asperity_separation"))
        names = ("adhesion_parameter", "asperity_plasticity_index", "surface_height_std", "asperity_height_std",
                 "critical_interference", "asperity_radius", "asperity_density", "nominal_area")
        self.lam, self.psi, self.sigma, self.asperity_sigma, self.omega_c, radius, density, area = (
            float(self.data[name][0]) for name in names)
        self.count = round(density * area)
        # Units of the scaled variables; the scenes have J/m^2 and GPa.
        work, modulus = (float(material[of].split()[0]) for of in ("work_of_adhesion", "reduced_modulus"))
        self.force, stiffness = np.pi * radius * work, 4.0 / 3.0 * 1e9 * modulus
        self.length = (self.force**2 / (radius * stiffness**2)) ** (1.0 / 3.0)
        self.radius = (self.force * radius / stiffness) ** (1.0 / 3.0)
        self.spacing = 2.0 * 1.03 / (np.pi * self.lam) * self.length  # Z0
        self.delta_a = -first_touch(self.lam) * self.length

    def by_law(self, law, name):
        return self.data[name][self.laws.index(law)]

    def number(self, law, name):
        return float(self.by_law(law, f"integral/{name}"))

    def place(self, law, name):
        """h* of the pull-off or of the peak stiffness of the integral."""
        return self.number(law, f"{name}_separation") / self.sigma

    def regime(self, law, *names):
        table = self.by_law(law, "integral/regime_adhesion_force")
        return sum(table[self.regimes.index(name)] for name in names)


class Program:
    """The program `stiction`, and the folder that its files are kept in."""

    def __init__(self, path, scenes, folder, keep = False, replicas = None):
        self.path, self.scenes, self.folder = path.absolute(), scenes, folder
        self.keep, self.replicas = keep, replicas
        if not path.is_file():
            raise PaperError(f"{path} is not there: build it with `cargo build --release`, or name another "
                             "by --program")

    def run(self, *arguments):
        done = subprocess.run([self.path, *map(str, arguments)], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise PaperError(f"`stiction {arguments[0]}` failed: {done.stderr.strip()}")
        return done.stdout

    def compare(self, scene, laws, ensemble = True):
        output = self.folder / f"{scene}.h5"
        if self.keep and output.is_file():
            return Comparison(output)
        more = ["--ensemble"] if ensemble else []
        more += ["--replicas", self.replicas] if ensemble and self.replicas else []
        self.run("compare", self.scenes / f"{scene}.toml", "--laws", laws, "--quiet", "--force", "-o", output,
                 *more)
        return Comparison(output)

    def asperity(self, law, lam, delta, path = "approach", *more):
        """One dry, elastic asperity at scaled approaches, in scaled variables."""
        with tempfile.TemporaryDirectory() as folder:
            table = Path(folder) / "approaches.csv"
            table.write_text("lambda,delta\n" + "".join(f"{lam!r},{float(x)!r}\n" for x in delta))
            rows = list(csv.DictReader(self.run("asperity", "--law", law, "--path", path, "--table",
                                                table, *more).splitlines()))
        numbers = ("delta", "adhesion_force", "external_force", "contact_radius")
        result = {name: np.array([float(row[name]) for row in rows]) for name in numbers}
        return result | {"branch": np.array([row["branch"] for row in rows])}

    def sphere(self, case, law, delta, path = "approach", *more):
        """One dry, elastic sphere of a case at approaches in m: forces in N."""
        result = self.asperity(law, case.lam, delta / case.length, path, *more)
        return result | {name: case.force * result[name] for name in ("adhesion_force", "external_force")}


def compare_all(program):
    """Everything that is computed of rough surfaces."""
    runs = {}
    for case in CASES:
        laws = "hybrid,fit:paper,emd,isbl" + (",sbl" if case == "III" else "")
        runs[case] = program.compare(f"case_{case.lower()}", laws)
    for energy in ENERGIES:
        runs[energy] = program.compare(f"case_iii_{energy}", "hybrid")
    runs["delta_A"] = program.compare("case_iii_delta_a", "fit:paper", ensemble=False)
    runs["retraction"] = program.compare("case_iii_retraction", "md_plastic,fit:paper", ensemble=False)
    return runs


def first_touch(lam):
    """Scaled approach at which a Maugis-Dugdale contact begins: its solution for a = 0."""
    alpha, beta = lam * np.pi / 4.0, 4.0 / 3.0 * lam**2 * (np.pi / 2.0 - 1.0)
    return -4.0 / 3.0 * lam * 2.0 / (beta + np.sqrt(beta**2 + 4.0 * alpha))


def noncontact(lam, z):
    """Scaled adhesive radius, approach and adhesion force of the extended model for z = h0/Z0 > 1.

    Eqs. 9 to 13 of the paper, where eq. 13 lacks -Z0: the approach is 0, not -Z0, at rigid contact."""
    stress = 8.0 / 3.0 * (z**-3 - z**-9) / 1.03
    work = 4.0 / 3.0 * z**-2 - z**-8 / 3.0
    b = 4.0 * (np.pi - 2.0) / (3.0 * np.pi) * lam * stress
    q = 4.0 * work / (np.pi * lam * stress)
    c = q / (b + np.sqrt(b**2 + q))
    delta = -((z - 1.0) * 2.0 * 1.03 / (np.pi * lam) + 4.0 / 3.0 * lam * stress * c)
    return c, delta, np.pi / 2.0 * lam * stress * c**2


def contact_zone(lam, radius, delta):
    """Scaled adhesive radius and adhesion force of a contact of scaled radius A = c cos(theta), from
    Delta = A^2 - (4/3) lambda c sin(theta)."""
    sine = 0.75 * (radius**2 - delta) / lam
    c, theta = np.hypot(radius, sine), np.arctan2(sine, radius)
    return c, lam * c**2 * (np.sin(theta) * np.cos(theta) + theta)


def fitted(case, law, force, delta):
    """f_snc, f_sel or f_f (eq. A.1) of a fit, N, at approaches in m. The file has nm and uN."""
    k = case.by_law(law, "fit/coefficients")
    x = delta / NM
    if force == "f_snc":
        return UN * (k[0] + 2.0 * k[1] / np.pi * k[2] / (4.0 * (x - k[3]) ** 2 + k[2] ** 2))
    if force == "f_sel":
        return UN * (k[4] + np.maximum(k[5] * x + k[6], 0.0) ** k[7])
    return UN * (k[8] + k[9] * x ** k[11] + k[10] * x ** k[12])


def fit_points(program, case, law, force, count = 801):
    """Approaches in m over the range of a fit, and there the direct solution and the fit, N."""
    start, end = case.by_law(law, "fit/range")[("f_snc", "f_sel", "f_f").index(force)]
    inside = 1e-9 * (end - start)
    delta = np.linspace(start + inside, end - inside, count)
    if force == "f_snc":  # of a dry sphere: the file counts the lubricant in
        delta += -case.delta_a - end
    direct = program.sphere(case, "emd", delta)["external_force" if force == "f_f" else "adhesion_force"]
    return delta, direct, fitted(case, law, force, delta)


def gaussian_sum(case, delta, force):
    """Sum over all asperities of a force that is 0 outside the approaches given, at every separation, N."""
    std = case.asperity_sigma
    density = np.exp(-0.5 * ((delta + case.d[:, None]) / std) ** 2) / (std * np.sqrt(2.0 * np.pi))
    values = force * density
    return case.count * 0.5 * ((values[:, 1:] + values[:, :-1]) * np.diff(delta)).sum(axis=1)


def without_contact_below_zero(program, case):
    """External force of the direct law when, as in eq. 20, asperities at -delta_A < delta < 0 have no contact
    force."""
    delta = np.linspace(-case.delta_a * (1.0 - 1e-12), 0.0, 2001)
    sphere = program.sphere(case, "emd", delta)
    contact = sphere["external_force"] + sphere["adhesion_force"]
    return case.by_law("hybrid", "integral/external_force") - gaussian_sum(case, delta, contact)


def paths_differ_from(program):
    """The smallest lambda at which a sphere leaves contact elsewhere than it came to it, by bisection."""

    def differ(lam):
        just_before = [first_touch(lam) * (1.0 + 1e-11)]
        approach, retraction = (program.asperity("emd", lam, just_before, path)["branch"][0]
                                for path in ("approach", "retraction"))
        return approach != retraction

    low, high = 0.5, 2.0
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if differ(middle) else (middle, high)
    return 0.5 * (low + high)
