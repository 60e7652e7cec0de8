//! A graph of landmarks. Its edges are plans, whose labels name two landmarks: the start and the destination of the
//! plan (paper, section IV-B).

use std::collections::{BTreeMap, VecDeque};

/// A plan that leads from one landmark to another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Edge {
    pub(crate) from: String,
    pub(crate) to: String,
    /// Name of the plan.
    pub(crate) plan: String,
}

/// The edges of a graph, in the order of its file.
#[derive(Debug)]
pub(crate) struct LandmarkGraph(Vec<Edge>);

impl LandmarkGraph {
    /// Creates the graph of labelled plans. Each pair contains a label, such as `Γ_from^to`, and the name of the plan
    /// with this label. A plan whose label does not name two landmarks is not an edge.
    pub(crate) fn of(labels: Vec<(String, String)>) -> Self {
        let edge = |(label, plan): (String, String)| {
            let (from, to) = label.strip_prefix("Γ_")?.split_once('^')?;
            Some(Edge { from: from.to_owned(), to: to.to_owned(), plan })
        };
        Self(labels.into_iter().filter_map(edge).collect())
    }

    /// Returns the names of the landmarks in the order of the file; each name is listed once.
    pub(crate) fn landmarks(&self) -> Vec<&str> {
        let mut names = Vec::new();
        for name in self.0.iter().flat_map(|edge| [&*edge.from, &*edge.to]) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// Returns a route with the fewest edges; `None` if there is no route. Among several such routes, it is the one
    /// whose edges come first in the file.
    pub(crate) fn route(&self, from: &str, to: &str) -> Option<Vec<&Edge>> {
        let mut came_by: BTreeMap<&str, Option<&Edge>> = BTreeMap::from([(from, None)]);
        let mut waiting = VecDeque::from([from]);
        while let Some(here) = waiting.pop_front() {
            for edge in self.0.iter().filter(|edge| edge.from == here) {
                if !came_by.contains_key(&*edge.to) {
                    came_by.insert(&edge.to, Some(edge));
                    waiting.push_back(&edge.to);
                }
            }
        }
        let mut edges = Vec::new();
        let mut here = to;
        while let Some(edge) = *came_by.get(here)? {
            edges.push(edge);
            here = &edge.from;
        }
        edges.reverse();
        Some(edges)
    }

    /// Returns the landmarks that can be reached from this one by a route, in the order of the file.
    pub(crate) fn reachable(&self, from: &str) -> Vec<&str> {
        let reaches = |to: &&str| *to != from && self.route(from, to).is_some();
        self.landmarks().into_iter().filter(reaches).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LANDMARKS: [&str; 3] = ["lab1", "lab2", "office"];

    fn pairs() -> Vec<(&'static str, &'static str)> {
        let all = LANDMARKS.iter().flat_map(|from| LANDMARKS.iter().map(move |to| (*from, *to)));
        all.filter(|(from, to)| from != to).collect()
    }

    fn graph<'e>(edges: impl Iterator<Item = &'e (&'static str, &'static str)>) -> LandmarkGraph {
        LandmarkGraph::of(edges.map(|(from, to)| (format!("Γ_{from}^{to}"), format!("{from}_{to}"))).collect())
    }

    fn words(graph: &LandmarkGraph, (from, to): (&str, &str)) -> Option<Vec<String>> {
        graph.route(from, to).map(|route| route.into_iter().map(|edge| edge.plan.clone()).collect())
    }

    #[test]
    fn a_route_leads_round_any_edge_that_is_missing() {
        for missing in pairs() {
            let graph = graph(pairs().iter().filter(|pair| **pair != missing));
            for (from, to) in pairs() {
                let third = LANDMARKS.into_iter().find(|name| *name != from && *name != to).unwrap();
                let expected = match (from, to) == missing {
                    true => vec![format!("{from}_{third}"), format!("{third}_{to}")],
                    false => vec![format!("{from}_{to}")],
                };
                assert_eq!(words(&graph, (from, to)), Some(expected), "{from} to {to} without {missing:?}");
            }
        }
    }

    #[test]
    fn a_graph_may_have_no_route() {
        let graph = graph([("lab1", "office"), ("lab2", "lab1")].iter());
        assert_eq!(words(&graph, ("lab2", "office")), Some(vec!["lab2_lab1".into(), "lab1_office".into()]));
        assert_eq!(words(&graph, ("office", "lab1")), None);
        assert_eq!(words(&graph, ("lab1", "lab1")), Some(Vec::new()));
        assert_eq!((graph.reachable("lab2"), graph.reachable("office")), (vec!["lab1", "office"], Vec::new()));
    }

    #[test]
    fn a_circle_of_edges_ends_the_search() {
        let graph = graph([("a", "b"), ("b", "a"), ("b", "b"), ("c", "d")].iter());
        assert_eq!(words(&graph, ("a", "d")), None);
        assert_eq!(graph.landmarks(), ["a", "b", "c", "d"]);
    }

    #[test]
    fn a_label_without_two_landmarks_is_no_edge() {
        let labels = ["Γ_robot1", "Γ_a^b", "Γ_"].map(|label| (label.to_owned(), "P".to_owned()));
        assert_eq!(LandmarkGraph::of(labels.to_vec()).landmarks(), ["a", "b"]);
    }
}
