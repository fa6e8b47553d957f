//! What false promises cost, and what reading takes.

use std::io::{BufReader, Read};

use contactbench::io;
use contactbench::run::alloc;
use flate2::Compression;

use super::examples::{DATA, DUMP, MERCURY, PLY_HEAD, VTK_HEAD, le, npy, npz, vtp};
use super::{HALF, NONE, gz, refusal, zlib};
use crate::quiet;

/// What a file promises costs nothing: memory follows the bytes that are there.
#[test]
fn promises_and_bombs_are_bounded() {
    let _guard = quiet();
    let bounded = |bytes: &[u8], options| {
        let (message, usage) = alloc::measure(|| refusal(bytes, "", options));
        let peak = usage.expect("the counting allocator is installed").peak_bytes;
        assert!(peak < 4 << 20, "{peak} bytes for: {message}");
        message
    };
    let many = 4_000_000_000u64;
    bounded(DUMP.replace("ATOMS\n2\n", &format!("ATOMS\n{many}\n")).as_bytes(), NONE);
    bounded(DATA.replace("2 atoms", &format!("{many} atoms")).as_bytes(), NONE);
    bounded(MERCURY.replacen("2 ", &format!("{many} "), 1).as_bytes(), NONE);
    bounded(
        format!("{VTK_HEAD}BINARY\nDATASET POLYDATA\nPOINTS {many} double\nabc").as_bytes(),
        HALF,
    );
    bounded(
        PLY_HEAD
            .replace("FORMAT", "binary_little_endian")
            .replace("vertex 2", &format!("vertex {many}"))
            .as_bytes(),
        NONE,
    );
    bounded(
        vtp("format=\"binary\"", "", "AAAAAAAA", "AAAAAAAA", "")
            .replace("NumberOfPoints=\"2\"", &format!("NumberOfPoints=\"{many}\""))
            .as_bytes(),
        NONE,
    );
    bounded(&npz(&[("arr_0.npy", npy(&format!("({many}, 3)"), &[1.0]))], true, false), HALF);
    bounded(&npy(&format!("({many}, 3)"), &[1.0]), HALF);

    // Seventy megabytes of nothing in seventy kilobytes.
    let line = [b"#".as_slice(), &[b' '; 1022], b"\n"].concat();
    let message = bounded(&gz(&line.repeat(1000)).repeat(70), NONE);
    assert!(message.contains("unpacks to more than 200 times its size"), "{message}");

    // A line without end; the reader would go on for ever.
    struct Endless;
    impl Read for Endless {
        fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
            bytes.fill(b'1');
            Ok(bytes.len())
        }
    }
    let (result, usage) =
        alloc::measure(|| io::load_from(BufReader::new(Endless), "p", "csv", NONE));
    assert_eq!(
        result.unwrap_err().to_string(),
        "p:1: the line is longer than 1048576 bytes; this is not a particle file"
    );
    assert!(usage.unwrap().peak_bytes < 4 << 20);
}

/// A hundred and sixty megabytes in some kilobytes: each layer is in proportion to the one around
/// it, and the whole is not.
#[test]
fn layers_of_compression_are_bounded_together() {
    let _guard = quiet();
    // What cannot be made smaller, and zeros: a hundredth and a half of it.
    let mut state = 1u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 12) as f64
    };
    let piece: Vec<f64> = (0..8192).map(|k| if k < 96 { noise() } else { 0.0 }).collect();
    let (piece, pieces) = (le(&piece), 2562);
    let refused = |bytes: &[u8]| {
        assert!(bytes.len() < 200_000, "{} bytes", bytes.len());
        let (message, usage) = alloc::measure(|| refusal(bytes, "", HALF));
        assert!(message.contains("unpacks to more than 200 times its size"), "{message}");
        let peak = usage.expect("the counting allocator is installed").peak_bytes;
        assert!(peak < 100 << 20, "{peak} bytes");
    };

    // One piece in deflate, ended so that it can be repeated.
    let mut deflate = flate2::Compress::new(Compression::best(), false);
    let mut packed = Vec::with_capacity(1 << 16);
    let header = npy(&format!("({}, 4)", pieces * piece.len() / 32), &[]);
    deflate.compress_vec(&header, &mut packed, flate2::FlushCompress::Full).unwrap();
    let start = packed.len();
    deflate.compress_vec(&piece, &mut packed, flate2::FlushCompress::Full).unwrap();
    let repeated = packed[start..].repeat(pieces);
    let member = [&packed[..start], &repeated, b"\x03\x00"].concat();
    assert!(member.len() * 100 > pieces * piece.len(), "the inner layer alone is in proportion");
    let mut archive = b"PK\x03\x04\x2d\0\0\0\x08\0\0\0\0\0\0\0\0\0".to_vec();
    archive.extend((member.len() as u32).to_le_bytes());
    archive.extend([0; 4]);
    archive.extend(b"\x09\0\0\0arr_0.npy");
    archive.extend(&member);
    archive.extend(b"PK\x01\x02 and so on");
    refused(&gz(&archive));

    let block = zlib(&piece);
    let mut data: Vec<u8> = [pieces as u32, piece.len() as u32, 0]
        .into_iter()
        .chain(std::iter::repeat_n(block.len() as u32, pieces))
        .flat_map(u32::to_le_bytes)
        .collect();
    data.extend(block.repeat(pieces));
    let vtu = format!(
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" \
         compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid><Piece \
         NumberOfPoints=\"{}\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" \
         format=\"appended\" offset=\"0\"/></Points></Piece></UnstructuredGrid><AppendedData \
         encoding=\"raw\">_",
        pieces * piece.len() / 24
    );
    refused(&gz(&[vtu.as_bytes(), &data, b"</AppendedData></VTKFile>"].concat()));
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
        let (scene, usage) = alloc::measure(|| io::from(&bytes[..], "p", "", NONE).unwrap());
        let peak = usage.expect("the counting allocator is installed").peak_bytes;
        assert_eq!(scene.len(), n);
        let most = 5 * (24 * n as u64) / 2;
        println!("{peak} bytes, {:.2} times the coordinates", peak as f64 / (24 * n) as f64);
        assert!(peak <= most, "{peak} bytes; at most {most}");
    }
}
