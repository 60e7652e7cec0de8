//! Protects turns against delays that other programs cause: turns run with real-time scheduling and in memory that is
//! never paged out.

use rustix::mm::{MlockAllFlags, mlockall};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

/// Priority among real-time threads, from 1 to 99: above ordinary programs, but below the kernel's own threads.
const PRIORITY: u8 = 50;
/// Name of real-time scheduling in messages.
const SCHEDULING: &str = "real-time scheduling";
/// Name of locked memory in messages.
const MEMORY: &str = "locked memory";

/// Gives this thread precedence over all ordinary threads, and keeps all memory of this process in RAM. Memory that is
/// allocated later may be paged out. If it were locked too, a limit on locked memory would make allocations fail during
/// a run; turns themselves allocate nothing.
///
/// # Errors
/// Returns a message about what the system does not permit. The run continues without it.
pub(crate) fn claim() -> Result<(), String> {
    let is_scheduled = schedule(PRIORITY);
    let is_locked = mlockall(MlockAllFlags::CURRENT).is_ok();
    let claims = [(SCHEDULING, is_scheduled), (MEMORY, is_locked)];
    let refused: Vec<_> = claims.into_iter().filter(|(_, is_granted)| !is_granted).map(|(what, _)| what).collect();
    if refused.is_empty() { Ok(()) } else { Err(refused.join(" and ")) }
}

/// Gives this worker thread precedence over all ordinary threads, but not over the thread that makes the turns. Without
/// permission, it stays an ordinary thread; the run warns about that.
pub fn claim_for_worker() {
    let _ = schedule(PRIORITY.saturating_sub(1));
}

/// Sets real-time scheduling with this priority for this thread; returns `true` if the system permits it.
fn schedule(priority: u8) -> bool {
    let first_in_first_out = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    ThreadPriority::try_from(priority)
        .is_ok_and(|priority| set_thread_priority_and_policy(thread_native_id(), priority, first_in_first_out).is_ok())
}

#[cfg(test)]
mod tests {
    use super::{MEMORY, PRIORITY, SCHEDULING, claim};

    /// Returns the scheduling policy and the real-time priority of this thread (fields 41 and 40 of proc(5)), and the
    /// size of its locked memory in kB.
    fn granted() -> (u32, u32, u64) {
        let stat = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
        let after_name: Vec<u32> = stat
            .rsplit(')')
            .next()
            .unwrap()
            .split_whitespace()
            .map(|field| field.parse().unwrap_or_default())
            .collect();
        let status = std::fs::read_to_string("/proc/thread-self/status").unwrap();
        let locked = status.lines().find_map(|line| line.strip_prefix("VmLck:")).unwrap();
        (after_name[38], after_name[37], locked.trim().trim_end_matches(" kB").parse().unwrap())
    }

    #[test]
    fn what_is_not_refused_is_granted() {
        // Scheduling is a property of a thread, so the test uses a thread of its own.
        let (answer, (policy, priority, locked)) = std::thread::spawn(|| (claim(), granted())).join().unwrap();
        let refused = |what: &str| answer.as_ref().is_err_and(|why| why.contains(what));
        let first_in_first_out = 1;
        assert_eq!((policy, priority) == (first_in_first_out, PRIORITY.into()), !refused(SCHEDULING));
        assert_eq!(locked > 0, !refused(MEMORY));
    }
}
