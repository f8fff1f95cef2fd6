"""Finite elements of a sphere that a rigid flat presses without friction: axisymmetric, perfectly plastic.

The deformations may be large. The elastic strain is logarithmic, its yield criterion that of von Mises on the
Kirchhoff stress, and its flow rule associated: the return to the yield surface is that of small strains
(E. A. de Souza Neto, D. Peric, D. R. J. Owen, Computational Methods for Plasticity, Wiley 2008, chapter 14).
Quadrilaterals of four nodes take the mean of the change of volume over the element, against locking.

The solid is half of a sphere of radius 1, from the apex to the equator, and its reduced modulus E/(1 - nu^2)
is 1. The equator does not move along the axis. The coordinates are r and the depth z below the apex before
contact. The nodes that the flat presses are at its depth omega; those that it would pull are free.
"""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

POISSON = 0.3
YOUNG = 1 - POISSON**2
SHEAR, BULK = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))

# Five components of a gradient: dv_r/dr, dv_r/dz, dv_z/dr, dv_z/dz, v_r/r.
UNIT = np.array([1.0, 0, 0, 1, 1])
SYMMETRIC = np.eye(5)
SYMMETRIC[1:3, 1:3] = 0.5
DEVIATOR = SYMMETRIC - np.outer(UNIT, UNIT) / 3
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
POINTS = CORNERS / np.sqrt(3)
SHAPES = (1 + POINTS[:, None, 0] * CORNERS[:, 0]) * (1 + POINTS[:, None, 1] * CORNERS[:, 1]) / 4
SLOPES = np.stack([CORNERS[:, 0] * (1 + POINTS[:, None, 1] * CORNERS[:, 1]) / 4,
                   CORNERS[:, 1] * (1 + POINTS[:, None, 0] * CORNERS[:, 0]) / 4], axis=1)


def half_sphere(fine, across, growth):
    """Nodes, elements, the nodes of the surface from the apex outwards, and those of the equator.

    From the apex there are `across` squares of the side `fine` both ways, then rings that widen by at most
    `growth` to the equator. The mesh is made in a quarter of a disc and mapped conformally.
    """
    ring = [(across, j) for j in range(across)] + [(j, across) for j in range(across, -1, -1)]
    square = np.array(ring) * fine
    angle = np.arange(2 * across + 1) * np.pi / (4 * across)
    circle = 2 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    # The width of rings grows from that of a square; the outermost are scaled to end at the equator.
    widths = [fine]
    while sum(widths) < 2 - across * fine:
        widths.append(widths[-1] * min(growth, 1 + 0.04 * len(widths)))
    reach = np.cumsum(widths) / sum(widths)
    inner = [(i * fine, j * fine) for j in range(across + 1) for i in range(across + 1)]
    outer = [square + part * (circle - square) for part in reach]
    place = np.concatenate([np.array(inner), *outer])
    number = np.arange((across + 1) ** 2).reshape(across + 1, across + 1)  # by j, then i
    elements = [number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]]
    elements = [np.stack([corner.ravel() for corner in elements], axis=1)]
    before = np.array([number[j, i] for i, j in ring])
    rims = (across + 1) ** 2 + np.arange(len(reach) * len(ring)).reshape(len(reach), len(ring))
    for rim in rims:
        elements.append(np.stack([before[:-1], rim[:-1], rim[1:], before[1:]], axis=1))
        before = rim
    surface = np.concatenate([number[0], rims[:, 0]])
    flat = place[:, 0] + 1j * place[:, 1]
    mapped = flat / (1 - 0.5j * flat)
    nodes = np.stack([mapped.real, mapped.imag], axis=1)
    nodes[place[:, 0] == 0, 0] = 0
    nodes[number[:, 0], 0] = 0
    nodes[rims[:, -1], 0] = 0
    return nodes, np.concatenate(elements), surface, rims[-1]


class Body:
    """A half sphere of a yield strength, its displacement and its plastic strain."""

    def __init__(self, mesh, strength, load):
        self.nodes, self.elements, self.surface, equator = mesh
        self.strength, self.load = strength, load
        count = 2 * len(self.nodes)
        self.dofs = np.stack([2 * self.elements, 2 * self.elements + 1], axis=2).reshape(-1, 8)
        axis = np.flatnonzero(self.nodes[:, 0] == 0)
        self.held = np.zeros(count, bool)
        self.held[2 * axis] = True
        self.held[2 * equator + 1] = True
        self.gradient, radius, area = self.at_points(self.nodes)
        self.volume = 2 * np.pi * radius * area
        self.radius = radius
        # The inverse of the plastic deformation's square: rr, rz, zz, and around the axis.
        self.plastic = np.broadcast_to(np.array([1.0, 0, 1, 1]), (*radius.shape, 4)).copy()
        self.displacement = np.zeros(count)
        self.touching = np.zeros(len(self.surface), bool)
        self.omega = 0.0
        self.matrix_pattern(count)

    def at_points(self, nodes):
        """Gradients of the shapes, radius and area of the points of integration of a mesh."""
        corners = nodes[self.elements]
        jacobian = np.einsum("pda,eac->epdc", SLOPES, corners)
        area = jacobian[..., 0, 0] * jacobian[..., 1, 1] - jacobian[..., 0, 1] * jacobian[..., 1, 0]
        inverse = np.empty_like(jacobian)
        inverse[..., 0, 0], inverse[..., 1, 1] = jacobian[..., 1, 1], jacobian[..., 0, 0]
        inverse[..., 0, 1], inverse[..., 1, 0] = -jacobian[..., 0, 1], -jacobian[..., 1, 0]
        inverse /= area[..., None, None]
        radius = np.einsum("pa,ea->ep", SHAPES, corners[..., 0])
        return np.einsum("epcd,pda->epca", inverse, SLOPES), radius, area

    def matrix_pattern(self, count):
        """Where the entries of the elements' matrices go in the sparse matrix of all."""
        row = np.repeat(self.dofs, 8, axis=1).ravel()
        column = np.tile(self.dofs, (1, 8)).ravel()
        places, self.entry = np.unique(column.astype(np.int64) * count + row, return_inverse=True)
        self.row, self.column = places % count, places // count
        self.starts = np.concatenate([[0], np.cumsum(np.bincount(self.column, minlength=count))])
        self.diagonal = self.row == self.column

    def deformation(self, displacement):
        """The deformation gradient with the mean change of volume of the element, and the operators that give
        the gradient of a further displacement, without and with it."""
        moved = self.nodes + displacement.reshape(-1, 2)
        gradient, radius, area = self.at_points(moved)
        if area.min() <= 0:
            raise ArithmeticError("an element has turned over")
        u = displacement[self.dofs].reshape(len(self.elements), 4, 2)
        f = np.einsum("epca,eab->epbc", self.gradient, u)  # du_b/dX_c
        stretch = radius / self.radius
        f[..., 0, 0] += 1
        f[..., 1, 1] += 1
        change = (f[..., 0, 0] * f[..., 1, 1] - f[..., 0, 1] * f[..., 1, 0]) * stretch
        now = 2 * np.pi * radius * area
        mean = (now.sum(axis=1) / self.volume.sum(axis=1))[:, None]
        factor = np.cbrt(mean / change)
        operator = np.zeros((*radius.shape, 5, 8))
        operator[..., 0, 0::2] = operator[..., 2, 1::2] = gradient[..., 0, :]
        operator[..., 1, 0::2] = operator[..., 3, 1::2] = gradient[..., 1, :]
        operator[..., 4, 0::2] = SHAPES / radius[..., None]
        trace = operator[..., 0, :] + operator[..., 3, :] + operator[..., 4, :]
        average = np.einsum("ep,epi->ei", now, trace) / now.sum(axis=1)[:, None]
        smooth = operator + UNIT[:, None] * ((average[:, None] - trace) / 3)[..., None, :]
        return f * factor[..., None, None], stretch * factor, operator, smooth

    def stress(self, f, stretch):
        """The Kirchhoff stress, its derivative by the strain, and the plastic deformation after a step."""
        c = self.plastic
        middle = np.empty((*stretch.shape, 2, 2))
        middle[..., 0, 0], middle[..., 1, 1] = c[..., 0], c[..., 2]
        middle[..., 0, 1] = middle[..., 1, 0] = c[..., 1]
        trial = f @ middle @ f.swapaxes(-1, -2)
        around = stretch**2 * c[..., 3]
        strain = np.empty((*stretch.shape, 5))
        self.logarithm(trial, strain)
        strain[..., :4] /= 2
        strain[..., 4] = np.log(around) / 2
        volume = strain @ UNIT
        deviator = strain - volume[..., None] / 3 * UNIT
        size = np.sqrt(np.einsum("epi,epi->ep", deviator, deviator))
        limit = np.sqrt(2 / 3) * self.strength / (2 * SHEAR)
        yields = size > limit
        kept = np.where(yields, limit / np.maximum(size, limit), 1.0)
        elastic = deviator * kept[..., None]
        stress = 2 * SHEAR * elastic + BULK * volume[..., None] * UNIT
        direction = deviator / np.maximum(size, 1e-300)[..., None]
        tangent = 2 * SHEAR * kept[..., None, None] * DEVIATOR + BULK * np.outer(UNIT, UNIT)
        softening = (2 * SHEAR * kept * yields)[..., None] * direction
        tangent -= softening[..., :, None] * direction[..., None, :]
        # The inverse of the plastic deformation's square, from the elastic strain.
        elastic += volume[..., None] / 3 * UNIT
        square = self.exponential(2 * elastic)
        determinant = f[..., 0, 0] * f[..., 1, 1] - f[..., 0, 1] * f[..., 1, 0]
        back = np.empty_like(f)
        back[..., 0, 0], back[..., 1, 1] = f[..., 1, 1], f[..., 0, 0]
        back[..., 0, 1], back[..., 1, 0] = -f[..., 0, 1], -f[..., 1, 0]
        back /= determinant[..., None, None]
        inverse = back @ square @ back.swapaxes(-1, -2)
        plastic = np.stack([inverse[..., 0, 0], inverse[..., 0, 1], inverse[..., 1, 1],
                            np.exp(2 * elastic[..., 4]) / stretch**2], axis=-1)
        return stress, tangent, np.where(yields[..., None], plastic, c)

    @staticmethod
    def logarithm(matrix, out):
        """The logarithm of symmetric matrices of two rows, into the first four components."""
        mean = (matrix[..., 0, 0] + matrix[..., 1, 1]) / 2
        half = (matrix[..., 0, 0] - matrix[..., 1, 1]) / 2
        spread = np.hypot(half, matrix[..., 0, 1])
        ratio = spread / mean
        # (log of one principal value - log of the other)/(their difference)
        slope = np.where(ratio > 1e-8, np.arctanh(ratio) / np.maximum(spread, 1e-300), 1 / mean)
        level = np.log(mean) + np.log1p(-ratio**2) / 2
        out[..., 0], out[..., 3] = level + slope * half, level - slope * half
        out[..., 1] = out[..., 2] = slope * matrix[..., 0, 1]

    @staticmethod
    def exponential(tensor):
        """The exponential of the symmetric tensors' first four components, as matrices."""
        mean = (tensor[..., 0] + tensor[..., 3]) / 2
        half = (tensor[..., 0] - tensor[..., 3]) / 2
        spread = np.hypot(half, tensor[..., 1])
        level = np.exp(mean)
        slope = level * np.where(spread > 1e-8, np.sinh(spread) / np.maximum(spread, 1e-300), 1.0)
        out = np.empty((*mean.shape, 2, 2))
        even = level * np.cosh(spread)
        out[..., 0, 0], out[..., 1, 1] = even + slope * half, even - slope * half
        out[..., 0, 1] = out[..., 1, 0] = slope * tensor[..., 1]
        return out

    def forces(self, displacement):
        """Inner forces of the nodes and the matrix of their derivative, and the plastic deformation."""
        f, stretch, operator, smooth = self.deformation(displacement)
        stress, tangent, plastic = self.stress(f, stretch)
        weight = self.volume[..., None, None]
        local = np.einsum("epk,epki->ei", stress * self.volume[..., None], smooth)
        force = np.bincount(self.dofs.ravel(), local.ravel(), len(displacement))
        matrix = (smooth.swapaxes(-1, -2) @ (tangent * weight) @ smooth
                  + operator.swapaxes(-1, -2) @ (turning(stress) * weight) @ operator).sum(axis=1)
        return force, np.bincount(self.entry, matrix.ravel(), len(self.row)), plastic

    def press(self, omega):
        """Moves the flat to the depth omega, in as many steps as it takes. Returns its load."""
        try:
            load = self.equilibrium(omega)
        except ArithmeticError:
            if abs(omega - self.omega) < 1e-3 * omega:
                raise
            self.press((self.omega + omega) / 2)
            return self.press(omega)
        self.omega = omega
        return load

    def equilibrium(self, omega, tolerance=1e-6):
        """Moves the flat to the depth omega in one step; None takes it away. Returns its load."""
        displacement, touching = self.displacement.copy(), self.touching.copy()
        if omega is None:
            omega, touching[:] = -1.0, False
        downs = 2 * self.surface + 1
        force, entries, plastic = self.forces(displacement)
        for _ in range(60):
            gap = self.nodes[self.surface, 1] + displacement[downs] - omega
            fixed = self.held.copy()
            fixed[downs[touching]] = True
            norm = np.linalg.norm(force[~fixed]) / self.load
            if np.abs(gap[touching]).max(initial=0) < 1e-12 and norm < 1e-3:
                pulled, met = touching & (force[downs] < -1e-7 * self.load), ~touching & (gap < -1e-9)
                if pulled.any() or met.any():
                    touching = (touching & ~pulled) | met
                    continue
                if norm < tolerance:
                    self.displacement, self.plastic, self.touching = displacement, plastic, touching
                    return force[downs[touching]].sum()
            given = np.zeros(len(force))
            given[downs[touching]] = -gap[touching]
            change = self.solve(entries, force, fixed, given)
            for _ in range(5):
                force, entries, plastic = self.forces(displacement + change)
                if given.any() or np.linalg.norm(force[~fixed]) < self.load * max(norm, tolerance):
                    break
                change /= 2
            displacement = displacement + change
        raise ArithmeticError("no equilibrium")

    def solve(self, entries, force, fixed, given):
        """The displacement that takes away the forces, to first order, with that of fixed nodes given."""
        right = -force - np.bincount(self.row, entries * given[self.column], len(force))
        right[fixed] = given[fixed]
        entries = np.where(fixed[self.row] | fixed[self.column], 0.0, entries)
        entries[self.diagonal & fixed[self.row]] = 1.0
        matrix = sparse.csc_matrix((entries, self.row, self.starts), shape=(len(force),) * 2)
        return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                    options={"SymmetricMode": True}).solve(right)

    def outline(self):
        """Radius and depth of the nodes of the surface."""
        moved = (self.nodes + self.displacement.reshape(-1, 2))[self.surface]
        return moved[:, 0], moved[:, 1]


def turning(stress):
    """The part of the derivative of the forces that the stress has by turning with the body.

    For the gradient l of a displacement, with transpose l', and the Kirchhoff stress t, it is the tensor
    (l t - l' t - t l - t l')/2: the Jaumann rate less t l', as a matrix that acts on the components of l.
    """
    full = np.zeros((*stress.shape[:-1], 5, 5))
    pairs = [(0, 0), (0, 1), (1, 0), (1, 1)]
    tau = stress[..., :4].reshape(*stress.shape[:-1], 2, 2)
    for row, (i, j) in enumerate(pairs):
        for column, (k, m) in enumerate(pairs):
            if i == k:
                full[..., row, column] += tau[..., m, j] / 2
            if i == m:
                full[..., row, column] -= tau[..., k, j] / 2
            if m == j:
                full[..., row, column] -= tau[..., i, k] / 2
            if k == j:
                full[..., row, column] -= tau[..., i, m] / 2
    full[..., 4, 4] -= stress[..., 4]
    return full
