//! The check at the end of a line: a fingerprint of all bytes before it. It detects edits and
//! damage but is not a signature.

pub const NAME: &str = "check";
const KEY: &str = ",\"check\":\"0x";
const END: &str = "\"}";
const DIGITS: usize = 16;

/// Computes the 64-bit FNV-1a hash.
fn fingerprint(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
    })
}

/// Adds the check as the last field of a JSON object, which must not be empty.
pub fn sealed(object: &str) -> String {
    let open = object.trim_end().strip_suffix('}').unwrap_or(object);
    format!("{open}{KEY}{:016x}{END}", fingerprint(open.as_bytes()))
}

pub fn verify(line: &[u8]) -> Result<(), String> {
    let (open, said) = split(line).ok_or("it has no check at its end: it was edited")?;
    let right = format!("{:016x}", fingerprint(open));
    if said == right.as_bytes() {
        Ok(())
    } else {
        Err("its check does not match: it was edited".into())
    }
}

/// Returns the checked bytes, and the digits of the check.
fn split(line: &[u8]) -> Option<(&[u8], &[u8])> {
    let line = line.trim_ascii_end().strip_suffix(END.as_bytes())?;
    let (rest, digits) = line.split_at_checked(line.len().checked_sub(DIGITS)?)?;
    Some((rest.strip_suffix(KEY.as_bytes())?, digits))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bit_is_found_anywhere() {
        let line = sealed("{\"schema\":4,\"n\":100}");
        assert_eq!(line, "{\"schema\":4,\"n\":100,\"check\":\"0x6518063a6d63f90a\"}");
        assert_eq!(verify(line.as_bytes()), Ok(()));
        assert_eq!(verify(format!("{line}\r\n").as_bytes()), Ok(()));
        for k in 0..line.len() {
            let mut edited = line.clone().into_bytes();
            edited[k] ^= 1;
            assert!(verify(&edited).is_err(), "byte {k}");
        }
        for none in ["", "{}", "{\"check\":1}", "0x0123456789abcdef\"}"] {
            assert!(verify(none.as_bytes()).unwrap_err().contains("no check"), "{none}");
        }
    }
}
