//! Errors name their place.

use super::*;

#[test]
fn long_lines_and_missing_files_are_refused() {
    let long = [b"x,y,r\n1,2,3".as_slice(), &vec![b' '; LONGEST_LINE], b"\n"].concat();
    let message = read(&long, "csv", NONE).unwrap_err();
    assert!(message.starts_with("p:2: the line is longer than 1048576 bytes"), "{message}");
    let missing = scene(Path::new("/nowhere/p.csv"), NONE).unwrap_err();
    assert!(format!("{missing:#}").starts_with("cannot read /nowhere/p.csv: "), "{missing:#}");
    assert!(scene(Path::new("/"), NONE).is_err());
    let twice = read(&packed(&packed(b"x,y,r\n1,2,3\n")), "", NONE).unwrap_err();
    assert!(twice.contains("compressed twice"), "{twice}");
    let damaged = packed(format!("x,y,r\n{}", "1,2,3\n".repeat(1000)).as_bytes());
    let message = read(&damaged[..damaged.len() / 2], "", NONE).unwrap_err();
    assert!(message.starts_with("cannot read p"), "{message}");
}
