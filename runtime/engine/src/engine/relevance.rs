//! Determines the relevant modules: modules that are always relevant, modules that the plan reads, and modules that
//! other relevant modules read.

use super::loaded::LoadedModule;

/// Returns, for each module, `true` if it is relevant. `plan` yields the board positions of the attributes that the
/// plan reads.
pub(crate) fn relevant<Y>(modules: &[LoadedModule<Y>], plan: impl Iterator<Item = usize>) -> Vec<bool> {
    let owner = |place: usize| {
        let count = |module: &LoadedModule<Y>| module.declared.publishes.len();
        modules.iter().position(|module| (module.first..module.first + count(module)).contains(&place))
    };
    let mut relevant = vec![false; modules.len()];
    let always = (0..).zip(modules).filter(|(_, module)| module.is_always_relevant()).map(|(number, _)| number);
    let mut found: Vec<usize> = always.chain(plan.filter_map(owner)).collect();
    while let Some(number) = found.pop() {
        let Some(is_relevant) = relevant.get_mut(number).filter(|is_relevant| !**is_relevant) else { continue };
        *is_relevant = true;
        let wires = modules.get(number).map_or(&[][..], |module| &module.wires);
        found.extend(wires.iter().flatten().filter_map(|place| owner(*place)));
    }
    relevant
}
