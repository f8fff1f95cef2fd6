//! Forces between the mean planes under a body.
//!
//! # Formula
//! Surfaces that are h + s apart at the depth s act on an area dA(s) with the pressure p(h + s) of flat surfaces, Derjaguin's (1934)
//! approximation: the force is ∫p(h + s) dA down to the depth at which the body ends. A sphere has s = r²/2R_m. Divided by the
//! nominal area the force is a pressure, as of flat surfaces.

use super::shape::Depths;
use crate::background::{MeanPlaneForce, Strength};
use crate::math::piecewise::Piecewise;
use crate::math::quadrature::{NODES, Rule};
use std::sync::{Arc, OnceLock};

/// Relative accuracy of integrals over depths, and of tabulated strengths between flat surfaces.
const ACCURACY: f64 = 1e-12;
const OF_TABLE: f64 = 1e-12;
/// Times that a range of depths may be doubled: what is beyond is nothing.
const DOUBLINGS: i32 = 60;

impl Depths {
    /// The integrals of functions of the depth, m, over the area, m², of a body down to `deepest`, m. They vary over a `width`, m, or
    /// over the depth where that is more.
    pub fn integral<const N: usize>(
        &self,
        width: f64,
        deepest: f64,
        of: impl Fn(f64) -> [f64; N],
    ) -> [f64; N] {
        let deepest = deepest.min(self.shape.end());
        let area = |depth: f64| self.shape.area(depth, self.tip);
        let doubled = (0..DOUBLINGS).map(|i| width * 2.0_f64.powi(i)).take_while(|depth| *depth < deepest);
        let breaks: Vec<f64> = [0.0].into_iter().chain(doubled).chain([deepest]).map(area).collect();
        let at = |areas: &[f64; NODES], values: &mut [[f64; N]; NODES]| {
            values
                .iter_mut()
                .zip(areas)
                .for_each(|(value, area)| *value = of(self.shape.depth(*area, self.tip)));
        };
        let over = Rule::shared().integrate(&breaks, ACCURACY, at).value;
        let flat = if breaks[0] > 0.0 { of(0.0) } else { [0.0; N] };
        std::array::from_fn(|c| breaks[0] * flat[c] + over[c])
    }
}

/// A force between mean planes of which one is that of a body.
#[derive(Debug)]
pub(super) struct Curved {
    /// The force between flat surfaces.
    flat: Arc<dyn MeanPlaneForce>,
    depths: Depths,
    /// m².
    nominal_area: f64,
    /// The nearest separation h, m.
    nearest: f64,
    /// Energy and pressure between flat surfaces over the logarithm of the separation, once they have been asked for.
    tables: [OnceLock<Piecewise>; 2],
}

impl Curved {
    pub fn new(flat: Arc<dyn MeanPlaneForce>, depths: Depths, nominal_area: f64, nearest: f64) -> Self {
        Self { flat, depths, nominal_area, nearest, tables: Default::default() }
    }

    /// The table of a quantity.
    fn table(&self, quantity: usize, std: f64) -> &Piecewise {
        self.tables[quantity].get_or_init(|| {
            let of = |h: f64| match quantity {
                0 => self.flat.strength(std, h).energy,
                _ => self.flat.pressure(std, h),
            };
            let at = |x: f64| self.nearest + std * libm::expm1(x);
            let cancelled = |x: f64| if quantity == 0 { 0.0 } else { self.flat.cancelled(at(x)) };
            let tolerance = |x: f64, value: f64| OF_TABLE * (value.abs() + 2.0 * cancelled(x));
            Piecewise::new(|x| of(at(x)), tolerance, 0.0, libm::log1p(self.depths.shape.end() / std))
        })
    }

    /// The strength between flat surfaces at a separation h, m, as far as it is asked for.
    fn of_flat(&self, std: f64, separation: f64, all: bool) -> Strength {
        let x = libm::log1p((separation - self.nearest) / std);
        let of =
            |quantity: usize| self.table(quantity, std).run(&[x]).0.filter(|cell| !cell.value(x).is_nan());
        match (of(1), all.then(|| of(0))) {
            (Some(cell), None) => Strength { pressure: cell.value(x), ..Strength::default() },
            (Some(cell), Some(Some(energy))) => Strength {
                energy: energy.value(x),
                pressure: cell.value(x),
                slope: cell.slope(x) / (std + separation - self.nearest),
            },
            _ => self.flat.strength(std, separation),
        }
    }
}

impl MeanPlaneForce for Curved {
    fn strength(&self, std: f64, separation: f64) -> Strength {
        let at = |depth: f64| {
            let Strength { energy, pressure, slope } = self.of_flat(std, separation + depth, true);
            [energy, pressure, slope]
        };
        let [energy, pressure, slope] = self.depths.integral(std, f64::INFINITY, at);
        Strength { energy, pressure, slope }.times(1.0 / self.nominal_area)
    }

    fn pressure(&self, std: f64, separation: f64) -> f64 {
        let at = |depth: f64| [self.of_flat(std, separation + depth, false).pressure];
        self.depths.integral(std, f64::INFINITY, at)[0] / self.nominal_area
    }

    fn cancelled(&self, separation: f64) -> f64 {
        let at = |depth: f64| [self.flat.cancelled(separation + depth)];
        self.depths.integral(self.nearest.abs(), f64::INFINITY, at)[0] / self.nominal_area
    }

    fn about(&self) -> String {
        self.flat.about()
    }
}
