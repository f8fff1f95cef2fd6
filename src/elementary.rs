//! Elementary functions of the C library, by the crate `libm`.
//!
//! C libraries differ in the last digits of these functions, and crates that draw random numbers call them. What is linked with this
//! module has the same ones on all systems. It belongs to programs: a library would take the functions from its users.

#![allow(unsafe_code)]

/// Functions under the names that the C library has for them.
macro_rules! of_c {
    ($($name:ident($($argument:ident),+);)+) => {$(
        // SAFETY: the function has the name, the arguments and the result of the C standard.
        #[unsafe(no_mangle)]
        extern "C" fn $name($($argument: f64),+) -> f64 {
            libm::$name($($argument),+)
        }
    )+};
}

of_c! {
    acos(x);
    asin(x);
    atan(x);
    atan2(y, x);
    cbrt(x);
    cos(x);
    cosh(x);
    exp(x);
    exp2(x);
    expm1(x);
    hypot(x, y);
    log(x);
    log10(x);
    log1p(x);
    log2(x);
    pow(x, y);
    sin(x);
    sinh(x);
    tan(x);
    tanh(x);
}
