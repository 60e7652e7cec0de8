//! Tests that odometry detects a robot that has not reached the landmark to which its plan leads.

use super::*;

#[test]
fn a_robot_at_another_landmark_has_not_arrived() {
    let words = ["lab1", "office", "--start", "7.45,0.4,180", "--start-noise", "10cm,5deg", "--seed", "9950007"];
    let output = navigate(&folder("navigation_there"), &[&words[..], &["--goal", "11.5,0,0.9,270,15"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    // As printed in the paper, the plan ends its first atom half-way through a turn, and the robot stays at lab 1.
    let folder = folder("navigation_elsewhere");
    let graph = fs::read_to_string(root().join("plans/navigation/office.mdle")).unwrap();
    let printed = "  (Atom (atIsection 1001) (goAvoid 90 40 20))\n  (Atom (atIsection 0011 OR wait 30)";
    let begun = format!("  (Atom (wait 10) (rotate 90))\n{printed}");
    assert!(graph.contains(&begun), "{graph}");
    fs::write(folder.join("office.mdle"), graph.replace(&begun, printed)).unwrap();
    fs::copy(root().join("plans/navigation/landmarks.toml"), folder.join("landmarks.toml")).unwrap();
    let usual = ["navigate", "office.mdle"];
    let output = run(&folder, &[&usual[..], &words, &["--target", "sim", "--speed", "max"]].concat());
    assert_eq!(output.status.code(), Some(3), "{}", text(&output));
    insta::assert_snapshot!(landmarks(&output), @r#"
    route: lab1 -> office (Lab1ToOfficePlan)
    at lab1
    error: the robot is at lab1 and not at office, by odometry: 0.52 m from its place, and 3.55 m from that of office
    "#);
}

#[test]
fn a_robot_is_believed_without_places() {
    let folder = small_graph("navigation_places");
    let words = ["navigate", "graph.mdle", "a", "b", "--target", "sim", "--speed", "max"];
    let status = |b: &str| {
        let landmarks = format!(
            "[[landmark]]\nname = \"a\"\naxis = \"90\"\nplace = \"1, 1\"\n\n[[landmark]]\nname = \"b\"\naxis = \"0\"\n{b}"
        );
        fs::write(folder.join("landmarks.toml"), landmarks).unwrap();
        run(&folder, &words).status.code()
    };
    assert_eq!(status(""), Some(0));
    // The robot drives 20 cm along the axis of the first landmark.
    assert_eq!([status("place = \"1, 1.3\"\n"), status("place = \"1.3, 1\"\n")], [Some(0), Some(3)]);
    assert_eq!(status("place = \"1, 1.5m\"\n"), Some(3), "less than half of the way is driven");
    assert_eq!(status("place = \"1\"\n"), Some(2));
}
