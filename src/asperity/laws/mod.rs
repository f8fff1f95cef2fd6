//! The laws of one asperity, one per file, as [tables](super::table) of regimes. A new law is its file and its lines here.

pub mod capillary;
pub mod ceb;
pub mod dmt;
pub mod emd;
pub mod fit;
pub mod hertz;
pub mod hybrid;
pub mod idmt;
pub mod isbl;
pub mod jg;
pub mod jkr;
pub mod kogut_etsion;
pub mod md;
pub mod md_kim;
pub mod md_plastic;
pub mod sbl;
pub mod tn;
pub mod zmc;

use super::models::Adhesion;
use super::models::Plasticity::{Loading, LoadingAndUnloading, Without};
use super::models::{Model, PUBLISHED_FITS, law, plastic, validity, wet};
use md_plastic::PlasticContact::{JacksonGreen, KogutEtsion, ThorntonNing, ZhaoMaiettaChang};

/// All laws. `hertz` is the law of one asperity, `gw` the rough surface of such asperities.
#[rustfmt::skip]
pub const MODELS: &[Model] = &[
    plastic("md_plastic", "extended Maugis-Dugdale, also around the flattened summits of contacts that have yielded",
        validity(Adhesion::Any, LoadingAndUnloading, false), md_plastic::md_plastic),
    law("hybrid", "extended Maugis-Dugdale up to the critical interference, Kogut-Etsion above",
        validity(Adhesion::Any, Loading(KogutEtsion), false), hybrid::hybrid),
    law("emd", "extended Maugis-Dugdale up to the critical interference, no force above",
        validity(Adhesion::Any, Without, false), emd::emd),
    law(PUBLISHED_FITS, "the hybrid law with the published curve fits of its elastic part, for the three published asperities",
        validity(Adhesion::Any, Loading(KogutEtsion), false), fit::paper),
    law("isbl", "attraction of an undeformed sphere across the lubricant, Kogut-Etsion in contact",
        validity(Adhesion::Low, Loading(KogutEtsion), false), isbl::isbl),
    law("sbl", "attraction of an undeformed sphere across the lubricant, and around a contact of elastic profile",
        validity(Adhesion::Low, Loading(KogutEtsion), false), sbl::sbl),
    law("ke", "improved DMT before contact, Kogut-Etsion in contact, dry",
        validity(Adhesion::Low, Loading(KogutEtsion), true), kogut_etsion::ke),
    law("ceb", "improved DMT before contact, Hertz and Chang-Etsion-Bogy in contact, dry",
        validity(Adhesion::Low, Loading(KogutEtsion), true), ceb::ceb),
    law("zmc", "improved DMT before contact, Hertz and Zhao-Maietta-Chang in contact, dry",
        validity(Adhesion::Low, Loading(ZhaoMaiettaChang), true), zmc::zmc),
    law("jg", "improved DMT before contact, Hertz and Jackson-Green in contact, dry",
        validity(Adhesion::Low, Loading(JacksonGreen), true), jg::jg),
    law("tn", "improved DMT before contact, Hertz and Thornton-Ning in contact, dry",
        validity(Adhesion::Low, Loading(ThorntonNing), true), tn::tn),
    law("md", "Maugis-Dugdale in contact, nothing before it, elastic and dry",
        validity(Adhesion::Any, Without, true), md::md),
    law("md_kim", "Maugis-Dugdale in contact, constant stress before it, elastic and dry",
        validity(Adhesion::Any, Without, true), md_kim::md_kim),
    wet("capillary", "extended Maugis-Dugdale within bridges of a condensed liquid, also around flattened summits",
        validity(Adhesion::Any, LoadingAndUnloading, true), capillary::capillary),
    law("jkr", "Johnson-Kendall-Roberts, elastic and dry",
        validity(Adhesion::High, Without, true), jkr::jkr),
    law("dmt", "Derjaguin-Muller-Toporov, nothing before contact, elastic and dry",
        validity(Adhesion::Low, Without, true), dmt::dmt),
    law("idmt", "improved Derjaguin-Muller-Toporov: attraction before contact too, elastic and dry",
        validity(Adhesion::Low, Without, true), idmt::idmt),
    law("hertz", "Hertz contact without adhesion, elastic and dry",
        validity(Adhesion::Without, Without, true), hertz::hertz),
    law("gw", "Greenwood-Williamson: Hertz contacts without adhesion, elastic and dry",
        validity(Adhesion::Without, Without, true), hertz::hertz),
];

/// The law of a name.
pub fn model(name: &str) -> Option<Model> {
    MODELS.iter().find(|model| model.name == name).copied()
}
