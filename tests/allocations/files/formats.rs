//! Formats, radii and frames are found.

use contactbench::io::{Frame, Options, RadiusSource};

use super::examples::{DATA, DUMP, MERCURY, all};
use super::{HALF, NONE, gz, load, read_rows};
use crate::loud;

#[test]
fn every_format_is_told_by_its_content_and_read() {
    let _guard = loud();
    for (format, bytes) in all() {
        let shown = String::from_utf8_lossy(&bytes).into_owned();
        let radius = if format == "XYZ" { Some(0.5) } else { None };
        let options = Options { radius, ..NONE };
        let second = if format == "XYZ" { 0.5 } else { 0.25 };
        let expected = vec![vec![1.0, 2.0, 3.0, 0.5], vec![4.0, 5.0, 6.0, second]];
        let (rows, about) = read_rows(&bytes, "", options);
        assert_eq!((rows, about.format, about.gzip), (expected.clone(), format, false), "{shown}");
        let (rows, packed) = read_rows(&gz(&bytes), "", options);
        assert_eq!(rows, expected, "{format} in gzip");
        assert!(packed.gzip && packed.format == format);
    }
}

#[test]
fn the_source_of_the_radius_is_known() {
    let _guard = loud();
    let source = |bytes: &[u8], options| load(bytes, "", options).unwrap().1.radius;
    assert_eq!(source(DUMP.as_bytes(), NONE), RadiusSource::Column("radius".into()));
    assert_eq!(source(DATA.as_bytes(), NONE), RadiusSource::Halved("diameter".into()));
    assert_eq!(source(b"x,y\n1,2\n", HALF), RadiusSource::Given);
    let (particles, about) = load(b"x,y\n1,2\n", "", NONE).unwrap();
    assert_eq!(
        (particles.len(), particles.has_radii(), about.radius),
        (1, false, RadiusSource::Missing)
    );
    let (particles, _) = load(DUMP.as_bytes(), "", Options { ids: true, ..NONE }).unwrap();
    assert_eq!(particles.ids(), Some(&[7, 3][..]), "in file order, not sorted");
    // Discs: y, no z, and MercuryDPM's eight columns.
    assert_eq!(read_rows(b"1 0 0 0 9 9\n1 2 0 0 .5 0 0 0\n", "", NONE).0, [[1.0, 2.0, 0.5]]);
    assert_eq!(
        read_rows(b"1 0 0 0 0 9 9 0\n1 2 0 0 .5 0 0 0\n", "data", NONE).0,
        [[1.0, 2.0, 0.5]]
    );
    // Atoms without sizes, and without a style.
    let atomic = DATA
        .replace("Atoms # sphere", "Atoms")
        .replace("1 1.0 2500", "1")
        .replace("1 0.5 2500", "1");
    assert_eq!(
        read_rows(atomic.as_bytes(), "", HALF).0,
        [[1.0, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.5]]
    );
}

#[test]
fn one_of_several_frames_is_read() {
    let _guard = loud();
    let second = DUMP.replace("0.5 3 2 1", "0.5 3 2 9").replace("100", "200");
    let dump = format!("{DUMP}{second}");
    let xyz = "1\n\nA 1 2 3\n1\n\nA 9 2 3\n";
    let mercury = format!("{MERCURY}{}", MERCURY.replace("\n1 2 3", "\n9 2 3"));
    for text in [&dump, xyz, &mercury] {
        let first_x = |frame, survey| {
            let radius = text.starts_with("1\n").then_some(0.5);
            load(text.as_bytes(), "", Options { frame, survey, radius, ..NONE })
                .map(|(particles, about)| (particles.centre(0)[0], about.frame, about.frames))
        };
        assert_eq!(first_x(Frame::Number(0), true), Ok((1.0, 0, 2)));
        assert_eq!(first_x(Frame::Number(1), false), Ok((9.0, 1, 2)));
        assert_eq!(first_x(Frame::Last, false), Ok((9.0, 1, 2)));
        assert!(
            first_x(Frame::Only, false)
                .unwrap_err()
                .contains("a second frame begins; say which one")
        );
        assert_eq!(
            first_x(Frame::Number(2), false).unwrap_err(),
            "p holds 2 frames, numbered from 0; there is no frame 2"
        );
    }
    // A frame that is cut off hides those before it only from those who ask for the last.
    let cut = &dump[..dump.len() - 20];
    assert!(load(cut.as_bytes(), "", Options { frame: Frame::Number(0), ..NONE }).is_ok());
    assert!(
        load(cut.as_bytes(), "", Options { frame: Frame::Last, ..NONE })
            .unwrap_err()
            .starts_with("p")
    );
}
