//! The worlds in which each plan makes sense, and whether it requests contact.

/// Plans with the same name in a file or on a page of the book.
pub(super) struct Row {
    pub(super) file: &'static str,
    pub(super) plan: &'static str,
    /// Worlds in which the plan's path is free where the plan does not look: a plan that drives ahead for a certain
    /// time needs enough space. A plan that waits for `atIsection 1000` or for a range ahead must reach a wall at a
    /// right angle, because a sonar gets no echo from a slanting wall. A plan that crosses the way of the person who
    /// walks in `hall` must look around before it drives.
    pub(super) worlds: &'static str,
    /// Reason why the plan requests contact; empty if it does not request any.
    pub(super) asks: &'static str,
    /// Maximum percentage of runs with a contact that the plan does not request.
    pub(super) most: u64,
    /// Cause of the contacts that the plan does not request.
    pub(super) cause: &'static str,
}

const fn row(file: &'static str, plan: &'static str, worlds: &'static str) -> Row {
    Row { file, plan, worlds, asks: "", most: 0, cause: "" }
}

impl Row {
    /// Marks the plan as requesting contact, with the reason.
    const fn asks(self, asks: &'static str) -> Self {
        Self { asks, ..self }
    }

    /// Allows contacts that the plan does not request in at most `most` percent of the runs, with the cause.
    const fn touches(self, most: u64, cause: &'static str) -> Self {
        Self { most, cause, ..self }
    }
}

pub(super) const TABLE: &[Row] = &[
    row("plans/branching.mdle", "Branching", "floor, hall, home"),
    row("plans/dock.mdle", "Dock", "floor, hall"),
    row("plans/lab_tour.mdle", "LabTour", "office"),
    row("plans/patrol.mdle", "Patrol", "floor, hall, office, maze, home"),
    row("plans/patrol.mdle", "Patrol", "room").touches(15, "the way back is between the desk and a chair"),
    row("plans/retreat.mdle", "Explore", "floor, hall, room, home").asks("it explores by touch"),
    row("plans/sentry.mdle", "Sentry", "floor, hall, room, office, maze, home, yard"),
    row("plans/wall_following.mdle", "WallFollowing", "home"),
    row("plans/navigation/map.mdle", "MapDrive", "office")
        .touches(10, "`advance` drives an ATRV-mini, which slips, through a door of 0.9 m and back"),
    row("plans/navigation/office.mdle", "Circuit", "office"),
    row("plans/paper/lab1_to_office.mdle", "Lab1ToOfficePlan", "lab 1"),
    row("plans/paper/lab2_to_lab1.mdle", "Lab2ToLab1Plan", "office"),
    row("analysis.md", "Outing", "floor, hall, home, yard"),
    row("analysis.md", "Dock", "floor, hall, home"),
    row("conditions.md", "P", "floor").asks("it ends at a contact"),
    row("embedding.md", "Round", "floor, hall, home"),
    row("faults.md", "Approach", "floor, hall, home, yard"),
    row("first_plan.md", "First", "floor, hall"),
    row("language.md", "P", "floor"),
    row("language.md", "Outer", "floor, hall"),
    row("language.md", "ToTheOffice", "floor, hall, room, office, maze, home"),
    row("language.md", "Ahead", "floor, hall, office, home"),
    row("language.md", "Ahead", "room").touches(10, "furniture beside the way, and a rectangle that turns there"),
    row("language.md", "Ahead", "maze").touches(30, "a rectangle turns in passages of 1.2 m"),
    row("layout.md", "Dock", "floor, hall"),
    row("loops.md", "Main", "floor, hall").asks("it drives until it touches"),
    row("machines.md", "Rest", "floor, hall, home"),
    row("many_robots.md", "Idle", "floor, hall, home"),
    row("many_robots.md", "Square", "floor"),
    row("many_robots.md", "Wander", "floor, hall, office").asks("it turns away where it touches"),
    row("memory.md", "Main", "floor, hall").asks("it drives until it touches"),
    row("microcontroller.md", "Shuttle", "floor, hall, home"),
    row("names.md", "Tour", "floor, hall"),
    row("names.md", "Patrol", "floor, hall"),
    row("names.md", "Corridor", "floor, hall"),
    row("navigation.md", "Around", "floor, hall, office"),
    row("own_loop.md", "Shuttle", "floor, hall, home"),
    row("own_plan.md", "Side", "floor, hall, room, office, home"),
    row("own_plan.md", "Square", "floor"),
    row("own_plan.md", "Square", "hall").touches(5, "a rectangle turns beside a column"),
    row("own_robot.md", "Square", "floor, hall"),
    row("pictures.md", "Figure2", "floor, hall"),
    row("pictures.md", "Search", "room, home"),
    row("pictures.md", "Figure3", "floor").asks("it drives until it touches"),
    row("quarks.md", "Rounds", "floor, hall, room, home").asks("it turns away where it touches"),
    row("quarks.md", "Legs", "floor, office"),
    row("quarks.md", "Legs", "hall, room").touches(5, "a column or a chair beside the way"),
    row("quarks.md", "Metre", "floor, hall"),
    row("quarks.md", "P", "floor"),
    row("quarks.md", "Round", "floor, hall"),
    row("records.md", "Square", "floor, hall")
        .touches(2, "a rectangle turns beside a wall that gives no echo, because it slants"),
    row("reference/interfaces.md", "Lab", "floor, hall, office"),
    row("reference/interfaces.md", "Lab", "room").touches(25, "the point is outside: it drives about among furniture"),
    row("reference/interfaces.md", "Pair", "floor, hall, home"),
    row("reference/semantics.md", "Levels", "floor, hall, room, office, maze, home, yard"),
    row("ros2.md", "FirstDrive", "floor, hall"),
    row("safety.md", "Rush", "floor"),
    row("safety.md", "Retreat", "floor"),
    row("safety.md", "Ahead", "floor"),
    row("shell.md", "Ahead", "floor, hall"),
    row("shell.md", "Go", "floor").asks("it ends at a contact"),
    row("shell.md", "Null", "floor, hall"),
    row("simulator.md", "Ahead", "floor"),
    row("simulator.md", "Ahead", "hall").touches(10, "the walker comes up from a side while the robot stands"),
    row("simulator.md", "Ahead", "room").touches(30, "furniture beside the way, most often a rectangle at 30 cm/s"),
    row("simulator.md", "Along", "maze"),
    row("simulator.md", "Home", "home"),
    row("state_machine.md", "Main", "floor, hall").asks("it drives until it touches"),
    row("testing.md", "Dock", "floor, hall"),
    row("theorem_1.md", "Beacon", "floor, hall, room, office, maze, home, yard"),
    row("turns.md", "Main", "floor, hall").asks("it drives until it touches"),
    row("what_a_plan_is.md", "Approach", "floor, hall"),
    row("what_a_plan_is.md", "Dock", "floor, hall"),
    row("why.md", "Dock", "floor, hall"),
    row("without_compiler.md", "Square", "floor, hall, home"),
    row("worlds.md", "Cross", "yard"),
];
