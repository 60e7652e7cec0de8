//! The listings of section IV of the paper, exactly as printed there.

use super::{Arena, check, parse};
use crate::diagnostic::SourceId;

const SOUND_FOLLOW: &str = include_str!("../../../../../plans/paper/sound_following.mdle");
const LAB2_TO_LAB1: &str = include_str!("../../../../../plans/paper/lab2_to_lab1.mdle");
const LAB1_TO_OFFICE: &str = include_str!("../../../../../plans/paper/lab1_to_office.mdle");
const ROBOT1: &str = include_str!("../../../../../plans/paper/first_robot.mdle");
const ROBOT2: &str = include_str!("../../../../../plans/paper/second_robot.mdle");

/// The listings in the order of the paper.
pub(super) const ALL: [&str; 5] = [SOUND_FOLLOW, LAB2_TO_LAB1, LAB1_TO_OFFICE, ROBOT1, ROBOT2];

#[test]
fn the_papers_listings_are_read_as_printed() {
    check("the_papers_listings_are_read_as_printed", &ALL);
}

#[test]
fn the_papers_listings_are_read_from_one_file() {
    let text = ALL.concat();
    let arena = Arena::new();
    let (file, diagnostics) = parse(SourceId(0), &text, &arena);
    assert_eq!(diagnostics, []);
    let names: Vec<_> = file.plans.iter().map(|plan| plan.name.node).collect();
    assert_eq!(
        names,
        ["SoundFollowingRobot", "Lab2ToLab1Plan", "Lab1ToOfficePlan", "FirstRobotPlan", "SecondRobotPlan"]
    );
}
