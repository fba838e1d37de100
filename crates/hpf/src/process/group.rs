//! A command and all that it starts: ended together, and gone before another command is started.
//!
//! A command is often a launcher, and the program that holds the robot its child. On Unix the command leads a process
//! group of its own, which its children share; on Linux its environment also has a mark, by which processes are found
//! that have left the group, as daemons do. On other systems only the command itself is known.

use core::time::Duration;
use std::io;
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// The name of the mark in the environment.
const MARK: &str = "HPF_WORKER";
/// Time from the signal that asks processes to end until they are killed.
const WARNING: Duration = Duration::from_secs(2);
/// Time after the kill within which processes must be gone.
const DYING: Duration = Duration::from_secs(5);
/// Time between checks of what is left.
const GLANCE: Duration = Duration::from_millis(10);

/// A signal to all processes of a group.
#[derive(Clone, Copy, Debug)]
enum Order {
    /// A request to end.
    Terminate,
    /// A kill.
    Kill,
}

/// A command that was started, and all that it started.
pub struct Group {
    leader: Child,
    mark: String,
}

impl Group {
    /// Starts `command` with pipes to its stdin and from its stdout.
    ///
    /// # Errors
    /// What the system says.
    pub fn start(mut command: Command, number: usize) -> io::Result<(Self, ChildStdin, ChildStdout)> {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
        let mark = format!("{}-{since}-{number}", std::process::id());
        command.env(MARK, &mark).stdin(Stdio::piped()).stdout(Stdio::piped());
        // Ctrl-C is for hpf, too: motions under way are to be finished.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut leader = command.spawn()?;
        let (stdin, stdout) = (leader.stdin.take().expect("piped"), leader.stdout.take().expect("piped"));
        Ok((Self { leader, mark }, stdin, stdout))
    }

    /// How the command itself ended, once it has; it has `patience` to do so.
    pub fn status(&mut self, patience: Duration) -> Option<ExitStatus> {
        let begun = Instant::now();
        loop {
            match self.leader.try_wait() {
                Ok(Some(status)) => return Some(status),
                Ok(None) if begun.elapsed() < patience => thread::sleep(GLANCE),
                _ => return None,
            }
        }
    }

    /// Ends all of it: after `patience`, which is cut short where `is_urgent`, processes are asked to end, and killed where
    /// they do not.
    ///
    /// # Errors
    /// Which processes cannot be ended.
    pub fn end(&mut self, patience: Duration, is_urgent: impl Fn() -> bool) -> Result<(), String> {
        if self.is_gone_within(patience, &is_urgent) {
            return Ok(());
        }
        self.tell(Order::Terminate);
        if self.is_gone_within(WARNING, || false) {
            return Ok(());
        }
        let begun = Instant::now();
        while begun.elapsed() < DYING {
            // Again and again: what is killed may have started something a moment before.
            self.tell(Order::Kill);
            if self.is_gone_within(GLANCE, || false) {
                return Ok(());
            }
        }
        Err(format!("cannot be ended: process {} or what it started is still there after a kill", self.leader.id()))
    }

    fn is_gone_within(&mut self, patience: Duration, is_urgent: impl Fn() -> bool) -> bool {
        let begun = Instant::now();
        loop {
            let is_gone = self.status(Duration::ZERO).is_some() && self.is_empty();
            if is_gone || begun.elapsed() >= patience || is_urgent() {
                return is_gone;
            }
            thread::sleep(GLANCE);
        }
    }
}

#[cfg(unix)]
mod unix {
    use nix::errno::Errno;
    use nix::sys::signal::{Signal, kill, killpg};
    use nix::unistd::Pid;

    use super::{Group, Order};

    impl Group {
        fn id(&self) -> Pid {
            Pid::from_raw(i32::try_from(self.leader.id()).unwrap_or(i32::MAX))
        }

        /// Whether nothing is left but the command itself.
        pub(super) fn is_empty(&self) -> bool {
            if cfg!(target_os = "linux") {
                self.members().is_empty()
            } else {
                killpg(self.id(), None) == Err(Errno::ESRCH)
            }
        }

        /// Sends a signal to all processes that are left.
        pub(super) fn tell(&self, order: Order) {
            let signal = match order {
                Order::Terminate => Signal::SIGTERM,
                Order::Kill => Signal::SIGKILL,
            };
            let _ = killpg(self.id(), signal);
            for member in self.members().into_iter().filter(|member| member.group != self.id().as_raw()) {
                let _ = kill(Pid::from_raw(member.id), signal);
            }
        }

        /// The processes in the group or with its mark, as the system lists them; those that are dead and not waited for
        /// are none.
        fn members(&self) -> Vec<Member> {
            let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
            let ids = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
            let mark = format!("{}={}", super::MARK, self.mark);
            let is_marked = |id: i32| {
                let variables = std::fs::read(format!("/proc/{id}/environ")).unwrap_or_default();
                variables.split(|byte| *byte == 0).any(|variable| variable == mark.as_bytes())
            };
            let members = ids.filter_map(Member::read);
            members.filter(|member| member.group == self.id().as_raw() || is_marked(member.id)).collect()
        }
    }

    /// A process that is alive.
    struct Member {
        id: i32,
        group: i32,
    }

    impl Member {
        /// Process `id`; `None` where it is not, or dead.
        fn read(id: i32) -> Option<Self> {
            let line = std::fs::read(format!("/proc/{id}/stat")).ok()?;
            // The name is in brackets and may hold any byte: what follows the last one is state, parent and group.
            let end = line.iter().rposition(|byte| *byte == b')')?;
            let mut words = core::str::from_utf8(&line[end + 1..]).ok()?.split_whitespace();
            let (state, group) = (words.next()?, words.nth(1)?.parse().ok()?);
            if matches!(state, "Z" | "X" | "x") { None } else { Some(Self { id, group }) }
        }
    }
}

#[cfg(not(unix))]
impl Group {
    fn is_empty(&self) -> bool {
        true
    }

    fn tell(&mut self, _: Order) {
        // What cannot be killed is gone.
        let _ = self.leader.kill();
    }
}
