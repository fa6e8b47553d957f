//! Tests the memory for reading files, including files that announce more data than they contain.

use std::io::{BufReader, Read, Write};

use contactbench::io::{self, Options};
use contactbench::run::runner::alloc;
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::quiet;

const NONE: Options = Options::NONE;
const HALF: Options = Options { radius: Some(0.5), ..NONE };

/// Returns the error of reading a file, and the peak of memory in bytes.
fn refusal(bytes: &[u8], options: Options) -> (String, u64) {
    let (read, usage) = alloc::measure(|| io::load_from(bytes, "p", "", options));
    let message = read.map(|(_, about)| about).expect_err("it is refused");
    (format!("{message:#}"), usage.expect("the counting allocator is installed").peak_bytes)
}

fn gz(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn le(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn npy(shape: &str, values: &[f64]) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), &le(values)].concat()
}

fn npz(member: &[u8]) -> Vec<u8> {
    let mut archive = b"PK\x03\x04\x2d\0\0\0\x08\0\0\0\0\0\0\0\0\0".to_vec();
    archive.extend((member.len() as u32).to_le_bytes());
    archive.extend([0; 4]);
    archive.extend(b"\x09\0\0\0arr_0.npy");
    archive.extend(member);
    archive.extend(b"PK\x01\x02 and so on");
    archive
}

/// Memory depends on the bytes of a file, not on the sizes it announces.
#[test]
fn promises_and_bombs_are_bounded() {
    let _guard = quiet();
    let bounded = |bytes: &[u8]| {
        let (message, peak) = refusal(bytes, HALF);
        assert!(peak < 4 << 20, "{peak} bytes for: {message}");
        message
    };
    let many = 4_000_000_000_u64;
    for text in [
        format!("ITEM: NUMBER OF ATOMS\n{many}\nITEM: ATOMS x y z\n1 2 3\n"),
        format!("t\n\n{many} atoms\n\nAtoms # atomic\n\n1 1 2 3 4\n"),
        format!("{many}\n\nA 1 2 3\n"),
        format!(
            "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS {many} double\nab"
        ),
    ] {
        bounded(text.as_bytes());
    }
    let array = npy(&format!("({many}, 3)"), &[1.0]);
    bounded(&array);
    let mut deflate = flate2::write::DeflateEncoder::new(Vec::new(), Compression::fast());
    deflate.write_all(&array).unwrap();
    bounded(&npz(&deflate.finish().unwrap()));

    // A file of 70 KB that decompresses to 70 MB.
    let line = [b"#".as_slice(), &[b' '; 1022], b"\n"].concat();
    let message = bounded(&gz(&line.repeat(1000)).repeat(70));
    assert!(message.contains("200 times"), "{message}");

    // A reader that returns an endless line.
    struct Endless;
    impl Read for Endless {
        fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
            bytes.fill(b'1');
            Ok(bytes.len())
        }
    }
    let (result, usage) =
        alloc::measure(|| io::load_from(BufReader::new(Endless), "p", "csv", NONE));
    let message = result.unwrap_err().to_string();
    assert!(message.starts_with("p:1: ") && message.contains("1048576 bytes"), "{message}");
    assert!(usage.unwrap().peak_bytes < 4 << 20);
}

/// A few KB decompress to 160 MB: the compression ratio of each layer is within the limit, but not
/// that of both layers together.
#[test]
fn layers_of_compression_are_bounded_together() {
    let _guard = quiet();
    // Noise, which cannot be compressed, then zeros.
    let mut state = 1u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 12) as f64
    };
    let piece: Vec<f64> = (0..8192).map(|k| if k < 96 { noise() } else { 0.0 }).collect();
    let (piece, pieces) = (le(&piece), 2562);
    let refused = |bytes: &[u8]| {
        assert!(bytes.len() < 200_000, "{} bytes", bytes.len());
        let (message, peak) = refusal(bytes, HALF);
        assert!(message.contains("200 times"), "{message}");
        assert!(peak < 100 << 20, "{peak} bytes");
    };

    // One compressed piece, flushed so that it can be repeated.
    let mut deflate = flate2::Compress::new(Compression::best(), false);
    let mut packed = Vec::with_capacity(1 << 16);
    let header = npy(&format!("({}, 4)", pieces * piece.len() / 32), &[]);
    deflate.compress_vec(&header, &mut packed, flate2::FlushCompress::Full).unwrap();
    let start = packed.len();
    deflate.compress_vec(&piece, &mut packed, flate2::FlushCompress::Full).unwrap();
    let repeated = packed[start..].repeat(pieces);
    let member = [&packed[..start], &repeated, b"\x03\x00"].concat();
    assert!(member.len() * 100 > pieces * piece.len(), "the inner layer alone is in proportion");
    refused(&gz(&npz(&member)));
}

/// Reading takes at most 2.5 times the bytes of the coordinates, radii and buffers included.
#[test]
fn reading_takes_little_more_than_the_coordinates() {
    let _guard = quiet();
    let n = 150_000;
    let numbers =
        |k: usize| [k as f64 * 1.25, k as f64 / 3.0, 7.0 - k as f64, 1.0 + (k % 7) as f64];
    let text: String = (0..n).map(|k| numbers(k).map(|x| x.to_string()).join(",") + "\n").collect();
    let flat: Vec<f64> = (0..n).flat_map(numbers).collect();
    for bytes in [format!("x,y,z,r\n{text}").into_bytes(), npy(&format!("({n}, 4)"), &flat)] {
        let read = || io::load_from(&bytes[..], "p", "", NONE).unwrap().0.scene("p", None).unwrap();
        let (scene, usage) = alloc::measure(read);
        let peak = usage.expect("the counting allocator is installed").peak_bytes;
        assert_eq!(scene.len(), n);
        let most = 5 * (24 * n as u64) / 2;
        println!("{peak} bytes, {:.2} times the coordinates", peak as f64 / (24 * n) as f64);
        assert!(peak <= most, "{peak} bytes; at most {most}");
    }
}
