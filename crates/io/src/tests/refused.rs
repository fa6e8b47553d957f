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

#[test]
fn several_scenes_in_one_table_are_found_under_any_name() {
    let names = "fov ImageNumber image_number img POSITION_T t_s t/s ts tau seconds sec ms nt tick \
                 MCS sweep date day epoch snapnum run replicate sample trial config batch traj bild";
    for name in names.split_whitespace() {
        for number in ["id", "cell", "ObjectNumber"] {
            let table =
                format!("{name},{number},x,y,r\na,7,0,0,1\na,8,3,1,1\nb,7,1,0,1\nb,8,4,1,1\n");
            let message = read(table.as_bytes(), "csv", NONE).unwrap_err();
            assert!(message.contains(&format!("when '{name}' changes")), "{message}");
        }
    }
}
