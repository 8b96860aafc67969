//! Conversions between numbers that compilers turn into vector instructions on every processor.

use crate::camera::{LANES, Lanes};

/// 2²³: from here on, neighbouring numbers of single precision are 1 apart, and the last bits of a sum with it hold the
/// rounded number.
const WHOLE: f32 = 8_388_608.0;

/// Rounds a number from 0 to below 2²³ to the nearest whole one, halves to the even one.
#[inline(always)]
pub(crate) fn rounded(value: f32) -> u32 {
    (value + WHOLE).to_bits() & 0x007f_ffff
}

/// Converts a number below 2³¹.
#[inline(always)]
pub(crate) fn float(value: u32) -> f32 {
    value as i32 as f32
}

/// Returns the lesser of two numbers, the second one if one is NaN: one instruction, where `f32::min` takes three.
#[inline(always)]
pub(crate) fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Returns the greater of two numbers, the second one if one is NaN.
#[inline(always)]
pub(crate) fn most(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Returns the largest of sixteen numbers: half of them are compared with the other half, again and again, which takes four
/// steps in vectors instead of sixteen. NaN may win or not.
#[inline(always)]
pub(crate) fn largest_of(values: &Lanes) -> f32 {
    let mut values = *values;
    let mut half = LANES / 2;
    while half > 0 {
        for i in 0..half {
            values[i] = most(values[i], values[i + half]);
        }
        half /= 2;
    }
    values[0]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn numbers_are_rounded_to_the_nearest(value in 0.0f32..8_388_600.0) {
            prop_assert!((f64::from(rounded(value)) - f64::from(value)).abs() <= 0.5);
        }
    }

    #[test]
    fn every_byte_stays_as_it_is() {
        for value in 0..=255_u32 {
            assert_eq!(rounded(float(value)), value);
        }
    }
}
