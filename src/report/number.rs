//! Numbers as text: for people with a fixed count of decimals, for programs
//! with all their digits.

/// Numbers from here on are written as powers of ten on the page.
const LARGEST_PLAIN: f64 = 1e12;

/// A number for a person: `decimals` of them, commas between thousands.
/// A number that would be rounded to 0 without being 0 keeps two digits.
pub(super) fn readable(value: f64, decimals: usize) -> String {
    if value.is_nan() {
        return "NaN".to_owned();
    }
    if value.is_infinite() {
        let infinity = if value > 0.0 { "∞" } else { "−∞" };
        return infinity.to_owned();
    }
    let plain = format!("{:.decimals$}", value.abs());
    let rounds_to_zero = value != 0.0 && plain.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    let digits = if rounds_to_zero || value.abs() >= LARGEST_PLAIN {
        scientific(&format!("{:.1e}", value.abs()))
    } else {
        grouped(&plain)
    };
    let sign = if value < 0.0 { "−" } else { "" };
    format!("{sign}{digits}")
}

/// A number for a tooltip, where the decimals that matter are not known: four
/// significant digits.
pub(super) fn four_digits(value: f64) -> String {
    let exponent = decimal_exponent(value);
    if value == 0.0 || !value.is_finite() {
        readable(value, 0)
    } else if (-4..9).contains(&exponent) {
        let text = readable(value, usize::try_from(3 - exponent).unwrap_or(0));
        without_zeros(&text).to_owned()
    } else {
        let sign = if value < 0.0 { "−" } else { "" };
        format!("{sign}{}", scientific(&format!("{:.3e}", value.abs())))
    }
}

/// A number for a program: the shortest text that reads back as the same bits.
pub(super) fn exact(value: f64) -> String {
    if value.is_nan() {
        "NaN".to_owned()
    } else if value == 0.0 || value.is_infinite() || (-5..16).contains(&decimal_exponent(value)) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// Exponent of the first decimal digit: 2 for 345, -1 for 0.6; 0 for 0.
/// Taken from the text, because a rounded logarithm is off at powers of ten.
pub(super) fn decimal_exponent(value: f64) -> i32 {
    let text = format!("{value:e}");
    let exponent = text.split_once('e').map(|(_, exponent)| exponent);
    exponent.and_then(|text| text.parse().ok()).unwrap_or(0)
}

/// The number `mantissa * 10^exponent`, rounded once.
pub(super) fn decimal(mantissa: i64, exponent: i32) -> f64 {
    let text = format!("{mantissa}e{exponent}");
    text.parse()
        .expect("digits, e and an exponent are a number")
}

/// The text of `mantissa * 10^exponent`: plain where that is short.
pub(super) fn decimal_text(mantissa: i64, exponent: i32) -> String {
    let value = decimal(mantissa, exponent);
    let first = decimal_exponent(value);
    if mantissa == 0 {
        "0".to_owned()
    } else if (-4..6).contains(&first) {
        readable(value, usize::try_from(-exponent).unwrap_or(0))
    } else {
        let sign = if value < 0.0 { "−" } else { "" };
        let digits = usize::try_from(first - exponent).unwrap_or(0);
        let text = format!("{:.digits$e}", value.abs());
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        let digits = without_zeros(digits);
        format!("{sign}{}", scientific(&format!("{digits}e{power}")))
    }
}

/// Without the zeros behind the point that say nothing.
fn without_zeros(text: &str) -> &str {
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => text,
    }
}

/// `1.2e-7` as `1.2·10⁻⁷`, `1e3` as `10³`.
fn scientific(text: &str) -> String {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let raised: String = exponent.chars().map(superscript).collect();
    match mantissa {
        "1" => format!("10{raised}"),
        _ => format!("{mantissa}·10{raised}"),
    }
}

fn superscript(character: char) -> char {
    match character {
        '-' => '⁻',
        '0'..='9' => "⁰¹²³⁴⁵⁶⁷⁸⁹"
            .chars()
            .nth(character as usize - '0' as usize)
            .unwrap_or(character),
        other => other,
    }
}

/// Commas between the thousands of unsigned digits.
fn grouped(plain: &str) -> String {
    let whole = plain.find('.').unwrap_or(plain.len());
    let mut text = String::with_capacity(plain.len() + whole / 3);
    for (index, character) in plain.char_indices() {
        if index > 0 && index < whole && (whole - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(character);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_read_rounded_numbers() {
        for (value, decimals, text) in [
            (0.0, 2, "0.00"),
            (-0.0, 1, "0.0"),
            (1234567.891, 1, "1,234,567.9"),
            (999.0, 0, "999"),
            (-1000.0, 0, "−1,000"),
            (0.00012, 2, "1.2·10⁻⁴"),
            (-3e20, 2, "−3.0·10²⁰"),
            (f64::NAN, 3, "NaN"),
            (f64::NEG_INFINITY, 3, "−∞"),
        ] {
            assert_eq!(readable(value, decimals), text, "{value}");
        }
        for (value, text) in [
            (0.0, "0"),
            (12.5, "12.5"),
            (0.001234567, "0.001235"),
            (123456.0, "123,456"),
            (-2.5e-9, "−2.500·10⁻⁹"),
        ] {
            assert_eq!(four_digits(value), text, "{value}");
        }
    }

    #[test]
    fn programs_read_the_same_bits() {
        for value in [
            0.1,
            1e-300,
            1.0 / 3.0,
            -7e22,
            1e15,
            f64::MIN_POSITIVE,
            f64::MAX,
        ] {
            let text = exact(value);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
            assert!(text.len() < 26, "{text} is long");
        }
    }

    #[test]
    fn exponents_are_exact_at_powers_of_ten() {
        for exponent in -300..=300 {
            assert_eq!(decimal_exponent(decimal(1, exponent)), exponent);
        }
    }

    #[test]
    fn ticks_are_written_as_short_as_they_are() {
        for (mantissa, exponent, text) in [
            (25, -2, "0.25"),
            (5, 3, "5,000"),
            (1, 6, "10⁶"),
            (15, 6, "1.5·10⁷"),
            (-2, -9, "−2·10⁻⁹"),
            (10, 8, "10⁹"),
            (1005, 6, "1.005·10⁹"),
            (0, 4, "0"),
            (10, -1, "1.0"),
        ] {
            assert_eq!(decimal_text(mantissa, exponent), text);
        }
    }
}
