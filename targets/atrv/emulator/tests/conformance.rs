//! The driver on the emulated robot does what any robot must do, over a pseudo-terminal, in lockstep.

use mdle_conformance::Suite;
use mdle_emulator::OnItsLine;

mod robot;

#[test]
fn the_driver_conforms() {
    let mut stage = OnItsLine::<robot::Robot>::default();
    let report = Suite::on(&mut stage).diff_drive().odometry().bumper().sonar().paths().power().report();
    assert!(report.holds(), "{report}");
}
