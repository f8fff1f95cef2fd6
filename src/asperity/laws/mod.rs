//! The laws of one asperity, one per file, as [tables](super::table) of regimes.

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
