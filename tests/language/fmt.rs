//! Tests `mdlec fmt`: the canonical layout of random plans, and the effects of the command, through the real binary.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Output;

use mdle_compiler::diagnostic::SourceId;
use mdle_compiler::syntax::{Arena, format, outline::outline, parse};
use mdle_tests::chance::Chance;
use mdle_tests::executable::{folder, run_mdlec, run_mdlec_reading};
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::repository::{files, root};

/// A plan in a bad layout. `LAID_OUT` is the same plan in the canonical layout.
const ODD: &str = "{P(bumper)\n(Atom(wait 1 or bumper)stop)// one\r\n\n\n(Atom (wait 2) stop)\n}";
const LAID_OUT: &str = "{ P (bumper)\n  (Atom (wait 1 OR bumper) stop)    // one\n\n  (Atom (wait 2) stop)\n}\n";

/// Returns the tree of a text, without source positions.
fn tree(text: &str) -> String {
    let arena = Arena::new();
    let (file, found) = parse(SourceId(0), text, &arena);
    assert_eq!(found, [], "{text}");
    outline(&file)
}

/// Returns the text with a random separator in place of each space and line break, and the number of comments in the
/// separators. The comments are numbered from 0.
fn disordered(text: &str, chance: &mut Chance) -> (String, usize) {
    let (mut disordered, mut comments) = (String::new(), 0);
    for character in text.chars() {
        if !matches!(character, ' ' | '\n') {
            disordered.push(character);
            continue;
        }
        for _ in 0..=chance.below(3) {
            let gap = chance.pick(&[
                " ",
                " ",
                " ",
                " ",
                "\n",
                "\n\n\n",
                "\t",
                ";",
                "/*#*/",
                " // #\n",
                "\n// #\n",
                "\n/* #\n */ ",
                "\n/// #\n",
            ]);
            disordered += &gap.replace('#', &format!("#{comments}."));
            comments += usize::from(gap.contains('#'));
        }
        disordered.push(' ');
    }
    (disordered, comments)
}

/// Returns the numbers of the comments in a text, in order.
fn numbers(text: &str) -> Vec<usize> {
    text.split('#').skip(1).map(|rest| rest.split('.').next().unwrap().parse().unwrap()).collect()
}

#[test]
fn random_plans_keep_their_trees_and_every_comment() {
    for seed in 0..400 {
        let mut chance = Chance::new(seed);
        let plan = RandomPlan::new(&mut chance, 12, false).to_string();
        let (text, comments) = disordered(&plan, &mut chance);
        let formatted = format(SourceId(0), &text).unwrap_or_else(|found| panic!("seed {seed}: {found:?}\n{text}"));
        assert_eq!(tree(&formatted), tree(&text), "seed {seed}:\n{text}\n────\n{formatted}");
        assert_eq!(numbers(&formatted), (0..comments).collect::<Vec<_>>(), "seed {seed}:\n{text}\n────\n{formatted}");
        assert_eq!(format(SourceId(0), &formatted).as_ref(), Ok(&formatted), "seed {seed}:\n{text}");
    }
}

#[test]
fn commas_between_elements_change_nothing() {
    let mut commas = 0;
    for seed in 0..400 {
        let mut chance = Chance::new(seed);
        let plan = RandomPlan::new(&mut chance, 12, false);
        let (plain, with) = (plan.to_string(), plan.with_commas(&mut chance));
        assert_eq!(tree(&with), tree(&plain), "seed {seed}:\n{with}");
        assert_eq!(format(SourceId(0), &with), format(SourceId(0), &plain), "seed {seed}:\n{with}");
        commas += with.len() - plain.len();
    }
    assert!(commas > 1000, "{commas}");
}

#[test]
fn layout_does_not_depend_on_where_the_lines_of_a_plan_end() {
    for seed in 0..200 {
        let plan = RandomPlan::new(&mut Chance::new(seed), 12, false).to_string();
        let formatted = format(SourceId(0), &plan);
        assert!(formatted.is_ok(), "seed {seed}: {plan}");
        assert_eq!(format(SourceId(0), &plan.replace(' ', "\n")), formatted, "seed {seed}: {plan}");
    }
}

/// Asserts the exit status and the standard output of a command; returns standard error.
fn assert_says(output: &Output, status: i32, printed: &str) -> String {
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(status), "{message}");
    assert_eq!(String::from_utf8_lossy(&output.stdout), printed, "{message}");
    message
}

fn text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn the_plans_that_come_with_mdle_are_laid_out() {
    let all = files(&[".mdle"]);
    let plans = all.iter().map(|file| file.path.as_str());
    let mut arguments = vec!["fmt", "--check"];
    arguments.extend(plans.filter(|path| path.starts_with("plans/") && !path.starts_with("plans/paper/")));
    assert!(arguments.len() > 3, "{arguments:?}");
    assert_eq!(assert_says(&run_mdlec(&root(), &arguments), 0, ""), "");
}

#[test]
fn files_are_laid_out_in_place_and_keep_their_permissions() {
    let folder = folder("fmt_in_place");
    fs::write(folder.join("odd.mdle"), ODD).unwrap();
    fs::write(folder.join("good.mdle"), LAID_OUT).unwrap();
    fs::set_permissions(folder.join("odd.mdle"), PermissionsExt::from_mode(0o640)).unwrap();
    symlink("odd.mdle", folder.join("link.mdle")).unwrap();
    let unchanged = fs::metadata(folder.join("good.mdle")).unwrap().modified().unwrap();

    assert_eq!(assert_says(&run_mdlec(&folder, &["fmt", "good.mdle", "link.mdle"]), 0, ""), "");
    assert_eq!(text(&folder, "odd.mdle"), LAID_OUT);
    assert_eq!(fs::metadata(folder.join("odd.mdle")).unwrap().permissions().mode() & 0o777, 0o640);
    assert!(fs::symlink_metadata(folder.join("link.mdle")).unwrap().is_symlink());
    assert_eq!(fs::metadata(folder.join("good.mdle")).unwrap().modified().unwrap(), unchanged);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 3);
}

#[test]
fn check_lists_what_differs_and_writes_nothing() {
    let folder = folder("fmt_check");
    for (name, text) in [("one.mdle", ODD), ("two.mdle", LAID_OUT), ("three.mdle", ODD)] {
        fs::write(folder.join(name), text).unwrap();
    }
    let output = run_mdlec(&folder, &["fmt", "--check", "one.mdle", "two.mdle", "three.mdle"]);
    assert_eq!(assert_says(&output, 1, "one.mdle\nthree.mdle\n"), "");
    assert_eq!(text(&folder, "one.mdle"), ODD);
    assert_eq!(assert_says(&run_mdlec(&folder, &["fmt", "--check", "two.mdle"]), 0, ""), "");
}

#[test]
fn standard_input_is_printed() {
    let folder = folder("fmt_stdin");
    assert_eq!(assert_says(&run_mdlec_reading(&folder, &["fmt", "-"], ODD), 0, LAID_OUT), "");
    assert_eq!(assert_says(&run_mdlec_reading(&folder, &["fmt", "-"], LAID_OUT), 0, LAID_OUT), "");
    assert_eq!(assert_says(&run_mdlec_reading(&folder, &["fmt", "--check", "-"], ODD), 1, "-\n"), "");
    assert_eq!(assert_says(&run_mdlec_reading(&folder, &["fmt", "--check", "-"], LAID_OUT), 0, ""), "");
    let message = assert_says(&run_mdlec_reading(&folder, &["fmt", "-"], "{ P (Atom (bumper) }"), 1, "");
    assert!(message.contains("error[E0103]") && message.contains("standard input:1:"), "{message}");
}

#[test]
fn a_file_with_errors_stays_as_it_is_and_the_others_are_laid_out() {
    let folder = folder("fmt_errors");
    let wrong = "{P(bumper)\n(Atom(wait 1 stop)}\n";
    fs::write(folder.join("wrong.mdle"), wrong).unwrap();
    fs::write(folder.join("odd.mdle"), ODD).unwrap();
    let message = assert_says(&run_mdlec(&folder, &["fmt", "wrong.mdle", "odd.mdle"]), 1, "");
    assert!(message.contains("error[E0103]") && message.contains("wrong.mdle:2:"), "{message}");
    assert_eq!((text(&folder, "wrong.mdle").as_str(), text(&folder, "odd.mdle").as_str()), (wrong, LAID_OUT));

    let message = assert_says(&run_mdlec(&folder, &["fmt", "none.mdle", "wrong.mdle", "."]), 2, "");
    assert!(message.contains("there is no file `none.mdle`") && message.contains("`.` is a folder"), "{message}");
    assert_says(&run_mdlec(&folder, &["fmt"]), 2, "");
}
