//! Tests `advance`, `way` and `FRAME here` in plans.

use crate::alphabet;
use crate::diagnostic::Sources;
use crate::samples::{compiled, judged};
use crate::{builtin, compile};

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
fn a_way_needs_odometry() {
    let mut sources = Sources::default();
    let atoms = builtin::alphabets().iter().find(|file| !file.target).expect("atoms");
    let shared = alphabet::read(sources.add(atoms.file, atoms.text), atoms.text).0.expect("an alphabet");
    let text = "target drum : crate drum; capability diff_drive; use atoms; control go;";
    let own = alphabet::read(sources.add("alphabet.mdle", text), text).0.expect("an alphabet");
    let (alphabet, _) = alphabet::combine(own, &[shared]);
    let plan = "{ P (way > 20m)\n  (Atom (wait 1 OR NOT way < 3m) (go 20 0))\n}\n";
    let source = sources.add("plan.mdle", plan);
    let (compiled, found) = compile(source, plan, &alphabet, None);
    assert_eq!(compiled.len(), 0);
    insta::assert_snapshot!(found.iter().map(|diagnostic| sources.render(diagnostic)).collect::<String>(), @r#"
        error[E0401]: `drum` cannot measure `way`: it has no `odometry`
           ┌─ plan.mdle:1:6
           │
         1 │ { P (way > 20m)
           │      ^^^ needs `odometry`
           │
           ┌─ atoms/alphabet.mdle:74:8
           │
        74 │ signal way unit m tolerance 0.01 needs odometry;
           │        --- `way` is declared here
           │
           = help: `mdlec targets` lists the robots and what each has

        error[E0401]: `drum` cannot measure `way`: it has no `odometry`
           ┌─ plan.mdle:2:24
           │
         2 │   (Atom (wait 1 OR NOT way < 3m) (go 20 0))
           │                        ^^^ needs `odometry`
           │
           ┌─ atoms/alphabet.mdle:74:8
           │
        74 │ signal way unit m tolerance 0.01 needs odometry;
           │        --- `way` is declared here
           │
           = help: `mdlec targets` lists the robots and what each has
        "#);
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
