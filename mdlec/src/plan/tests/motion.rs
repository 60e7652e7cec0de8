//! `advance`, `way` and `FRAME here` as plans have them.

use crate::samples::{compiled, judged};

#[test]
fn ways_of_no_length_and_without_end() {
    insta::assert_snapshot!(judged(
        "{ P
  (Atom (null) advance 0)
  (Atom (null) advance -0.0cm 20)
  (Atom (null) advance inf)
  (Atom (null) advance 1m 0)
  (Atom (way > inf OR way > 3s OR way < x OR way > -1m) stop)
}",
        None
    ));
}

#[test]
fn a_frame_here_is_printed_as_it_is_read() {
    let text = "{ P (bumper)
  FRAME here (Atom (wait 5) goAvoid 0 3)
  FRAME 90 (FRAME here { Q (way > 3) FRAME 30deg (Atom (wait 5) rotate 0) })
  FRAME here ((Atom (wait 5) rotate 90) (Atom (wait 5) stop))
  FRAME here ((Atom (wait 6) rotate 90) (Atom (wait 6) stop))^3
  FRAME here ExecPlan 2 { (Atom (wait 7) rotate 90) (Atom (wait 7) stop) }
}";
    let plan = &compiled(text)[0].plan;
    insta::assert_snapshot!(plan.to_string());
    assert_eq!(compiled(&plan.to_string())[0].plan.to_string(), plan.to_string());
    let formal = plan.formal();
    insta::assert_snapshot!(formal);
    assert_eq!(compiled(&formal)[0].plan.formal(), formal);
}
