//! The sets of instructions that batches are compiled in, chosen when a program runs.
//!
//! Work that is marked `#[inline(always)]` throughout is compiled once for each set. The bits are the same in all of them.
//! AVX-512 is left out where debug assertions are on: it is a third of what a compiler has to do for a test.

pub use pulp::NullaryFnOnce;

/// The instructions that work is done in.
#[derive(Clone, Copy, Debug)]
pub struct Instructions(Set);

#[derive(Clone, Copy, Debug)]
enum Set {
    /// Those that every processor of this kind has: SSE2, NEON.
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2(pulp::x86::V3),
    #[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
    Avx512(pulp::x86::V4),
}

impl Instructions {
    /// The best that this processor has.
    pub fn best() -> Self {
        #[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
        if let Some(set) = pulp::x86::V4::try_new() {
            return Self(Set::Avx512(set));
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(set) = pulp::x86::V3::try_new() {
            return Self(Set::Avx2(set));
        }
        Self::portable()
    }

    /// Those that every processor has.
    pub fn portable() -> Self {
        Self(Set::Portable)
    }

    /// Does `work` in these instructions.
    #[inline(always)]
    pub fn run<W: NullaryFnOnce>(self, work: W) -> W::Output {
        match self.0 {
            Set::Portable => work.call(),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2(set) => set.vectorize(work),
            #[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
            Set::Avx512(set) => set.vectorize(work),
        }
    }
}
