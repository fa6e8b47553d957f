//! Tables of particles, through all verbs that read them.

use crate::common::{file, good, refused, run};

const DEM: &str = "frame,time,id,x,y,z,diameter,active\n0,0,1,0,0,0,1,1\n0,0,2,3,0,0,1,1\n\
                   1,0.1,1,0.75,0,0,1,1\n1,0.1,2,1.5,0,0,1,1\n";

#[test]
fn a_table_of_several_times_is_a_trajectory_to_all_verbs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "dem.csv", DEM);
    file(folder, "pairs.csv", "frame,i,j\n1,0,1\n");
    file(folder, "wrong.csv", "frame,i,j\n0,0,1\n1,0,1\n");
    file(folder, "walk.txt", "# id frame x y z r\n1 0 0 5 5 1\n1 1 0 5 5 1\n2 0 1 5 5 1\n");
    let last = good(folder, &["detect", "dem.csv"]);
    assert_eq!(last.stdout, "i,j\n0,1\n");
    assert!(last.stderr.contains("frame 1, the last of 0 to 1"), "{}", last.stderr);
    assert_eq!(good(folder, &["detect", "dem.csv", "--frame", "0"]).stdout, "i,j\n");
    let all = good(folder, &["detect", "dem.csv", "--frame", "all"]);
    assert_eq!(all.stdout, "frame,id1,id2\n1,1,2\n");
    let verify = |pairs| run(folder, &["verify", "dem.csv", "--pairs", pairs, "--frame", "all"]);
    assert_eq!((verify("pairs.csv").code, verify("wrong.csv").code), (Some(0), Some(1)));
    let track = good(folder, &["track", "dem.csv", "--json"]).stdout;
    let track: serde_json::Value = serde_json::from_str(&track).unwrap();
    assert_eq!((track["frames"].as_u64(), track["contacts"].as_u64()), (Some(2), Some(1)));
    assert!(good(folder, &["inspect", "dem.csv"]).stdout.contains("frame 1"));
    for frame in ["0", "last", "all"] {
        let sorted = ["walk.txt:4: the rows are not sorted by 'frame'", "frame=none"];
        refused(folder, &["detect", "walk.txt", "--frame", frame], &sorted);
    }
    let whole = good(folder, &["detect", "walk.txt", "--columns", "frame=none"]);
    assert_eq!(whole.stdout, "i,j\n0,1\n0,2\n1,2\n");
}

#[test]
fn the_box_units_and_sizes_of_a_table_count() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "woo.txt", "##PERIODIC:: 10 10 10\n0.25 5 5 0.5\n9.75 5 5 0.5\n");
    file(folder, "yade.txt", "##PERIODIC:: 10 10 10\n0.25 5 5 0.5 -1\n9.75 5 5 0.5 -1\n");
    file(
        folder,
        "mm.csv",
        "x (m),y (m),z (m),Diameter (mm)\n0.25,5,5,1000\n1.25,5,5,1000\n9.75,5,5,1000\n",
    );
    file(folder, "red.csv", "x,y,z,r,g,b\n0.25,5,5,120,30,20\n9.75,5,5,200,10,10\n");
    for arguments in
        [&["woo.txt"][..], &["yade.txt"], &["yade.txt", "--columns", "x=1,y=2,z=3,r=4"]]
    {
        let found = good(folder, &[&["detect"], arguments].concat());
        assert_eq!(found.stdout, "i,j,sx,sy,sz\n0,1,-1,0,0\n", "{arguments:?}");
    }
    let found = good(folder, &["detect", "mm.csv"]);
    assert_eq!(found.stdout, "i,j\n0,1\n");
    assert!(found.stderr.contains("multiplied by 1e-3"), "{}", found.stderr);
    refused(folder, &["detect", "red.csv"], &["'r' may be a size or red", "--columns r=r"]);
    let found = good(folder, &["detect", "red.csv", "--radius", "0.5"]);
    assert_eq!(found.stdout, "i,j\n");
    assert!(found.stderr.contains("the sizes in 'r' are not used"), "{}", found.stderr);
    assert_eq!(good(folder, &["detect", "red.csv", "--columns", "r=r"]).stdout, "i,j\n0,1\n");
}
