//! What a rig asks of the operating system for the thread of its loop. Linux only: elsewhere each wish is refused.

use crate::error::{Error, Result};

/// Largest priority of SCHED_FIFO on Linux.
const HIGHEST_PRIORITY: u8 = 99;
/// CPUs that a Linux mask of the usual size knows.
const MASK: usize = 1024;

/// Wishes for the loop's thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Realtime {
    /// Priority under SCHED_FIFO, 1 to 99.
    pub priority: Option<u8>,
    /// The one CPU to run on, counted from 0.
    pub cpu: Option<usize>,
    /// Keep all memory of the process in RAM.
    pub lock_memory: bool,
}

impl Realtime {
    /// Refuses values that no system takes.
    ///
    /// # Errors
    /// With the option and its value.
    pub fn check(&self) -> Result<()> {
        if let Some(priority) = self.priority.filter(|p| !(1..=HIGHEST_PRIORITY).contains(p)) {
            return Err(Error::field("", "--priority", format!("{priority} is not from 1 to {HIGHEST_PRIORITY}")));
        }
        if let Some(cpu) = self.cpu.filter(|cpu| *cpu >= MASK) {
            return Err(Error::field("", "--cpu", format!("{cpu} is not from 0 to {}", MASK - 1)));
        }
        Ok(())
    }

    /// Applies the wishes to the calling thread; the memory that is mapped now is locked, and brought in. Always: the
    /// thread's timers may not be held back to be served together (the timer slack, 50 µs by default).
    ///
    /// # Errors
    /// When the system refuses one, with the option, its value, the reason, and what would help.
    #[cfg(target_os = "linux")]
    pub fn apply(&self) -> Result<()> {
        use rustix::mm::{MlockAllFlags, mlockall};
        use rustix::thread::{CpuSet, sched_setaffinity, set_current_timer_slack};
        use thread_priority::{
            RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
            set_thread_priority_and_policy, thread_native_id,
        };

        // No wish of the user's: a kernel that will not is worse by those 50 µs, and that shows in the figures.
        let _ = set_current_timer_slack(std::num::NonZeroU64::new(1));
        if let Some(cpu) = self.cpu {
            let mut only = CpuSet::new();
            only.set(cpu);
            sched_setaffinity(None, &only).map_err(|e| refused("--cpu", &format!("{cpu}"), e, "no such CPU here?"))?;
        }
        if self.lock_memory {
            let help = "needs CAP_IPC_LOCK or a greater limit of locked memory (ulimit -l)";
            mlockall(MlockAllFlags::CURRENT).map_err(|e| refused("--lock-memory", "", e, help))?;
        }
        if let Some(priority) = self.priority {
            let value = ThreadPriorityValue::try_from(priority).map_err(|e| Error::field("", "--priority", e))?;
            let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
            let set = set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Crossplatform(value), policy);
            set.map_err(|e| {
                let reason = match e {
                    thread_priority::Error::OS(code) => std::io::Error::from_raw_os_error(code),
                    other => std::io::Error::other(other.to_string()),
                };
                let help = "SCHED_FIFO needs CAP_SYS_NICE or a limit of real-time priority (ulimit -r)";
                refused("--priority", &format!("{priority}"), reason, help)
            })?;
        }
        Ok(())
    }

    /// Refuses every wish: it is known on Linux only.
    ///
    /// # Errors
    /// Where there is a wish.
    #[cfg(not(target_os = "linux"))]
    pub fn apply(&self) -> Result<()> {
        let wishes = [
            (self.cpu.is_some(), "--cpu"),
            (self.lock_memory, "--lock-memory"),
            (self.priority.is_some(), "--priority"),
        ];
        match wishes.iter().find(|(wished, _)| *wished) {
            Some((_, option)) => Err(Error::field("", *option, "is available on Linux only")),
            None => Ok(()),
        }
    }
}

#[cfg(target_os = "linux")]
fn refused(option: &str, value: &str, reason: impl Into<std::io::Error>, help: &str) -> Error {
    let space = if value.is_empty() { "" } else { " " };
    Error::field("", option, format!("{value}{space}refused by the system: {}; {help}", reason.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_no_system_takes() {
        let said = |wishes: Realtime| wishes.check().unwrap_err().to_string();
        assert_eq!(said(Realtime { priority: Some(0), ..Realtime::default() }), "--priority: 0 is not from 1 to 99");
        assert_eq!(
            said(Realtime { priority: Some(100), ..Realtime::default() }),
            "--priority: 100 is not from 1 to 99"
        );
        assert_eq!(said(Realtime { cpu: Some(1024), ..Realtime::default() }), "--cpu: 1024 is not from 0 to 1023");
        Realtime { priority: Some(99), cpu: Some(0), lock_memory: true }.check().unwrap();
        Realtime::default().apply().unwrap();
    }
}
