//! Tests the state link of one robot.

use super::*;
use crate::attribute::AttributeName;
use crate::link::Letter;
use crate::module::Refusal;

fn pose(x: f64, y: f64, degrees: f64) -> Pose {
    Pose { x: Meters(x), y: Meters(y), theta: Radians::from_degrees(degrees) }
}

#[test]
fn poses_go_to_the_shared_axes_and_back() {
    let start = pose(2.0, 1.0, 90.0);
    let shared = outward(&start, &pose(3.0, 0.5, 45.0));
    let near = |one: &Pose, other: &Pose| one.distance(other).0 < 1e-12 && (one.theta.0 - other.theta.0).abs() < 1e-12;
    assert!(near(&shared, &pose(1.5, 4.0, 135.0)), "{shared:?}");
    assert!(near(&inward(&start, &shared), &pose(3.0, 0.5, 45.0)));
}

/// A link on which these states arrive in this order, one at a time.
struct Script(Vec<State>);

impl Link for Script {
    fn send(&mut self, _: &State, _: Nanos) {}

    fn receive(&mut self, _: Nanos, take: &mut dyn FnMut(State)) {
        if !self.0.is_empty() {
            take(self.0.remove(0));
        }
    }

    fn post(&mut self, _: &str, _: &Letter, _: Nanos) -> Result<(), String> {
        Ok(())
    }

    fn letters(&mut self, _: Nanos, _: &mut dyn FnMut(Letter)) {}
}

#[test]
fn a_clock_that_jumps_reorders_no_states() {
    let state = |number, x| State { pose: pose(x, 0.0, 0.0), ..State::of("ada", number) };
    let restarted = State { session: 1, ..state(1, 9.0) };
    let script = Script(vec![state(5, 5.0), state(6, 6.0), state(4, 4.0), restarted]);
    let mut link = StateLink::new(Box::new(script), "bob", Pose::ORIGIN);
    // The clock jumps an hour ahead, a minute back, and to a time before all earlier ones.
    let seen = [1, 3_600, 3_540, 0, 2].map(|seconds| {
        let now = Nanos(seconds * 1_000_000_000);
        link.receive(now, &mut Shared(Vec::new()));
        let peer = *link.sense(["ada"].into_iter(), now).peer("ada").unwrap();
        peer.state.map(|state| (state.pose.x.0, state.age.0))
    });
    assert_eq!(seen, [Some((5.0, 0)), Some((6.0, 0)), Some((6.0, 0)), Some((9.0, 0)), Some((9.0, 2_000_000_000))]);
}

/// Attributes that were put on a board, with their publication times.
struct Shared(Vec<(String, Value, u64)>);

impl Foreign for Shared {
    fn put_foreign(&mut self, name: &AttributeName, Reading { value, at }: Reading) -> Result<(), Refusal> {
        self.0.push((name.to_string(), value, at.0));
        Ok(())
    }
}

#[test]
fn the_time_on_the_way_counts_to_the_age() {
    let attributes =
        vec![SharedValue { name: AttributeName::new("heading", "range"), value: Value::Number(1.0), age: Nanos(3) }];
    let state = State { age: Nanos(20), attributes, ..State::of("ada", 1) };
    let (mut link, mut board) =
        (StateLink::new(Box::new(Script(vec![state])), "bob", Pose::ORIGIN), Shared(Vec::new()));
    link.receive(Nanos(100), &mut board);
    let age = |now| link.sense(["ada"].into_iter(), Nanos(now)).peer("ada").unwrap().state.unwrap().age;
    assert_eq!((age(100), age(150)), (Nanos(20), Nanos(70)));
    assert_eq!(board.0, [("/usr/ada_heading/range".to_owned(), Value::Number(1.0), 77)]);
}

#[test]
fn the_newest_state_counts_and_its_age_begins_when_it_arrives() {
    let state = |number, x| State {
        pose: pose(x, 0.0, 0.0),
        rounds: vec![("bob".to_owned(), number)],
        atom: number,
        attributes: vec![SharedValue {
            name: AttributeName::new("heading", "range"),
            value: Value::Length(Meters(x)),
            age: Nanos(number),
        }],
        ..State::of("ada", number)
    };
    let own = State { name: "bob".to_owned(), ..state(9, 9.0) };
    let script = Script(vec![own, state(2, 2.0), state(1, 1.0), state(3, 3.0)]);
    let mut link = StateLink::new(Box::new(script), "bob", pose(1.0, 0.0, 0.0));
    let (mut seen, mut board) = (Vec::new(), Shared(Vec::new()));
    for turn in 0..5 {
        assert_eq!(link.receive(Nanos(10 * turn), &mut board), Vec::<String>::new());
        let links = link.sense(["ada"].into_iter(), Nanos(10 * turn));
        let peer = *links.peer("ada").unwrap();
        seen.push(peer.state.map(|state| (state.pose.x.0, state.age.0, state.rounds, state.atom)));
    }
    assert_eq!(seen, [None, Some((1.0, 0, 2, 2)), Some((1.0, 10, 2, 2)), Some((2.0, 0, 3, 3)), Some((2.0, 10, 3, 3))]);
    let range = |x, at| ("/usr/ada_heading/range".to_owned(), Value::Length(Meters(x)), at);
    assert_eq!(board.0, [range(2.0, 8), range(3.0, 27)], "each value once, as old as it was when it was sent");
}

/// A board that accepts at most this number of attributes.
struct Full(usize);

impl Foreign for Full {
    fn put_foreign(&mut self, _: &AttributeName, _: Reading) -> Result<(), Refusal> {
        self.0 = self.0.checked_sub(1).ok_or(Refusal::TooMany(320))?;
        Ok(())
    }
}

/// Returns a state of this robot that shares these attributes.
fn sharing(robot: &str, number: u64, names: impl Iterator<Item = (String, String)>) -> State {
    let shared = |(module, attribute): (String, String)| SharedValue {
        name: AttributeName::new(&module, &attribute),
        value: Value::Number(1.0),
        age: Nanos::ZERO,
    };
    State { attributes: names.map(shared).collect(), ..State::of(robot, number) }
}

#[test]
fn names_of_attributes_are_bounded_and_reported_once() {
    let numbered = |number: u64| {
        let names =
            (0..ATTRIBUTES as u64).map(move |place| ("heading".to_owned(), format!("n{}", 40 * number + place)));
        sharing("ada", number, names)
    };
    for (room, reported) in [(usize::MAX, 1), (10, 31)] {
        let script = Script((0..50).map(numbered).collect());
        let mut link = StateLink::new(Box::new(script), "bob", Pose::ORIGIN);
        let mut board = Full(room);
        let messages: Vec<_> = (0..50).flat_map(|turn| link.receive(Nanos(turn), &mut board)).collect();
        assert_eq!(messages.len(), reported, "{messages:?}");
        assert!(usize::MAX - board.0 <= ATTRIBUTES || board.0 == 0, "a robot takes no places of the others");
        assert_eq!(
            messages.last().unwrap(),
            "warning: state link: ada shares more than 40 attributes: no more are taken"
        );
    }
}

#[test]
fn two_robots_share_no_module() {
    let states = |number| {
        let of_a = sharing("a", number, [("b_c".to_owned(), "range".to_owned())].into_iter());
        [of_a, sharing("a_b", number, [("c".to_owned(), "bearing".to_owned())].into_iter())]
    };
    let mut link = StateLink::new(Box::new(Script([1, 2].map(states).concat())), "bob", Pose::ORIGIN);
    let mut board = Shared(Vec::new());
    let messages: Vec<_> = (0..4).flat_map(|turn| link.receive(Nanos(turn), &mut board)).collect();
    let refused = "warning: state link: /usr/c/bearing of a_b is refused: the robot `a` shares the module `a_b_c`";
    assert_eq!(messages, [refused]);
    let names: Vec<_> = board.0.iter().map(|(name, ..)| name.as_str()).collect();
    assert_eq!(names, ["/usr/a_b_c/range", "/usr/a_b_c/range"]);
}
