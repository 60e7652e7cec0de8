//! The listings of section IV of the paper, exactly as printed there.

use super::{check, parse};
use crate::diagnostic::SourceId;

const SOUND_FOLLOW: &str = r"$$\Gamma_{\text{soundFollow}} = \{ \text{SoundFollowingRobot}(\text{bumper}) \\ (\text{Atom}(\text{wait } \infty) \text{ goAvoid}(\text{heading module})) \\ \}$$
";

const LAB2_TO_LAB1: &str = r" $\Gamma_{lab2}^{lab1} = \{$ 
  Lab2ToLab1Plan (bumper)
  (Atom (atIsection 0100) (goAvoid 90 40 20))
  (Atom (atIsection 0010) (go 0 0.36))
  (Atom (wait  $\infty$ ) align 7 9)
  (Atom (atIsection 1000) (goAvoid 0 40 20))
  (Atom (atIsection 0100) (go 0 0.36))
  (Atom (wait  $\infty$ ) align 3 5)
  (Atom (wait 7) (goAvoid 270 40 20))
  (Atom (atIsection 1000) (goAvoid 270 40 20))
 $\}$ 
";

const LAB1_TO_OFFICE: &str = r" $\Gamma_{lab}^{office} = \{$ 
  Lab1ToOfficePlan (bumper)
  (Atom (atIsection 1001) (goAvoid 90 40 20))
  (Atom (atIsection 0011) (go 0 0.36))
  (Atom (wait  $\infty$ ) align 11 13)
  (Atom (atIsection 0100) (goAvoid 180 40 20))
  (Atom (wait 10) (rotate 90));
 $\}$ 
";

const ROBOT1: &str = r" $\Gamma_{robot1} = \{$  FirstRobotPlan (bumper)
  ExecPlan 4 {
    (Atom (sync robot2) stop)
    (Atom (bumper) path(lastPath))
    (Atom (wait 2) go(0.5 0))
    (Atom (wait 10) rotate(180))
    (Atom (sync robot2) stop)
    (Atom (wait 2) go(0.5 0))
    (Atom (bumper) Follow(robot2))
    (Atom (wait 10) rotate(180)) }
  }
";

const ROBOT2: &str = r" $\Gamma_{robot2} = \{$  SecondRobotPlan (bumper)
  ExecPlan 4 {
    (Atom ((sync robot1) AND (sync robot3)) stop)
    (Atom (wait 1) go(0.5 0))
    (Atom (bumper) Follow(robot1))
    (Atom (wait 1) go(0.5 0))
    (Atom (wait 10) rotate(180))
    (Atom ((sync robot3) AND (sync robot1)) stop)
    (Atom (wait 1) go(0.5 0))
    (Atom (bumper) Follow(robot3))
    (Atom (wait 1) go(0.5 0))
    (Atom (wait 10) rotate(180)) }
  }
";

#[test]
fn the_papers_listings_are_read_as_printed() {
    check("the_papers_listings_are_read_as_printed", &[SOUND_FOLLOW, LAB2_TO_LAB1, LAB1_TO_OFFICE, ROBOT1, ROBOT2]);
}

#[test]
fn the_papers_listings_are_read_from_one_file() {
    let (file, diagnostics) =
        parse(SourceId(0), &[SOUND_FOLLOW, LAB2_TO_LAB1, LAB1_TO_OFFICE, ROBOT1, ROBOT2].concat());
    assert_eq!(diagnostics, []);
    let names: Vec<_> = file.plans.iter().map(|plan| plan.name.node.as_str()).collect();
    assert_eq!(
        names,
        ["SoundFollowingRobot", "Lab2ToLab1Plan", "Lab1ToOfficePlan", "FirstRobotPlan", "SecondRobotPlan"]
    );
}
