//! Names of the attributes that other robots share. The number of attributes per robot is limited, and the modules of
//! different robots must have different names.

use mdle_runtime::Nanos;

use super::state_frame::ATTRIBUTES;
use super::{Foreign, State};
use crate::attribute::{AttributeName, Reading};

/// Names of the attributes that all other robots share.
#[derive(Debug, Default)]
pub(super) struct ForeignNames(Vec<NamesOf>);

/// Names of the attributes that one robot shares. There are at most [`ATTRIBUTES`] accepted and refused names together.
#[derive(Debug)]
struct NamesOf {
    robot: String,
    /// Names of attributes that are on the board.
    taken: Vec<AttributeName>,
    /// Names that were refused and reported.
    refused: Vec<AttributeName>,
    /// `true` once it has been reported that the robot shares too many attributes.
    has_more: bool,
}

impl ForeignNames {
    /// Puts the attributes of a state on the board; `at` is the time at which the state arrived. Calls `say` with a
    /// message for each refused name, but only once per name.
    pub(super) fn put(&mut self, state: &State, at: Nanos, board: &mut dyn Foreign, say: &mut dyn FnMut(String)) {
        let robot = &state.name;
        let place = self.0.iter().position(|names| names.robot == *robot);
        let mut own = place.map_or_else(|| NamesOf::of(robot), |place| self.0.swap_remove(place));
        for shared in state.attributes.iter().take(ATTRIBUTES) {
            let name = shared.name_from(robot);
            let is_taken = own.taken.contains(&name);
            if own.refused.contains(&name) || !is_taken && !own.has_room(say) {
                continue;
            }
            let age = shared.age.0.saturating_add(state.age.0);
            let reading = Reading { value: shared.value.clone(), at: Nanos(at.0.saturating_sub(age)) };
            let put = match self.owner(&name) {
                // Two names can coincide: robot `a` with module `b_c`, and robot `a_b` with module `c`.
                Some(other) => Err(format!("the robot `{other}` shares the module `{}`", name.module)),
                None => board.put_foreign(&name, reading).map_err(|refusal| refusal.to_string()),
            };
            match put {
                Ok(()) if is_taken => {}
                Ok(()) => own.taken.push(name),
                Err(sentence) => {
                    say(format!("warning: state link: {} of {robot} is refused: {sentence}", shared.name));
                    own.refused.push(name);
                }
            }
        }
        self.0.push(own);
    }

    /// Returns the robot that shares attributes of the module that `name` names; `None` if no robot does.
    fn owner(&self, name: &AttributeName) -> Option<&str> {
        let owns = |names: &&NamesOf| names.taken.iter().any(|taken| taken.module == name.module);
        self.0.iter().find(owns).map(|names| names.robot.as_str())
    }
}

impl NamesOf {
    fn of(robot: &str) -> Self {
        Self { robot: robot.to_owned(), taken: Vec::new(), refused: Vec::new(), has_more: false }
    }

    /// Returns `true` if the robot may share one more attribute. Reports the first refusal.
    fn has_room(&mut self, say: &mut dyn FnMut(String)) -> bool {
        let has_room = self.taken.len() + self.refused.len() < ATTRIBUTES;
        if !has_room && !std::mem::replace(&mut self.has_more, true) {
            let robot = &self.robot;
            say(format!("warning: state link: {robot} shares more than {ATTRIBUTES} attributes: no more are taken"));
        }
        has_room
    }
}
