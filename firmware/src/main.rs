//! The loop of a Cortex-M: runs the movement, prints what an update costs, and fails where a bit or a bound is off.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
mod bare {
    use core::mem::size_of;
    use core::panic::PanicInfo;

    use cortex_m::peripheral::syst::SystClkSource;
    use cortex_m_rt::entry;
    use cortex_m_semihosting::{debug, hprintln};
    use hpf_firmware::{
        Arm, DOUBLE_GOLDEN, DOUBLE_UPDATES, Family, Fingerprint, GOLDEN, N, Room, UPDATES, arm, double_arm, dt, input,
    };

    /// Most instructions of one update, by family: what was measured on the M4F and 2 %.
    const fn bound(family: Family) -> u32 {
        match family {
            Family::Phase => 3160,
            Family::Time => 1970,
        }
    }

    /// Most stack of one update [bytes].
    const STACK_BOUND: usize = 1024;
    /// Stack that is painted to see how far an update reaches [bytes].
    const PAINTED: usize = 4096;
    const PAINT: u32 = 0xdead_beef;

    #[panic_handler]
    fn panic(info: &PanicInfo<'_>) -> ! {
        hprintln!("{}", info);
        debug::exit(debug::EXIT_FAILURE);
        loop {
            cortex_m::asm::wfi();
        }
    }

    /// SysTick counts at 25 MHz, an instruction takes 64 ns under `-icount shift=6`.
    fn instructions(ticks: u32) -> u32 {
        ticks * 10 / 16
    }

    /// Paints the stack below the caller; returns the painted words' lowest address.
    #[inline(never)]
    fn paint() -> *mut u32 {
        let top = cortex_m::register::msp::read() as usize - 64;
        let low = (top - PAINTED) as *mut u32;
        for i in 0..PAINTED / 4 {
            // SAFETY: this lies below the stack pointer, in RAM that nothing else uses.
            unsafe { low.add(i).write_volatile(PAINT) };
        }
        low
    }

    /// Bytes of paint that are gone, counted from above.
    fn used(low: *mut u32) -> usize {
        // SAFETY: as for `paint`.
        let whole = (0..PAINTED / 4).take_while(|&i| unsafe { low.add(i).read_volatile() } == PAINT).count();
        PAINTED - 4 * whole
    }

    /// One update as the loop calls it: what is timed.
    #[inline(never)]
    fn timed(arm: &mut Arm, tick: u32) -> u32 {
        let input = input(tick);
        let before = cortex_m::peripheral::SYST::get_current();
        let output = arm.update(&input, dt());
        let after = cortex_m::peripheral::SYST::get_current();
        core::hint::black_box(output);
        before.wrapping_sub(after) & 0x00ff_ffff
    }

    #[entry]
    fn main() -> ! {
        let mut clock = cortex_m::Peripherals::take().expect("taken once").SYST;
        clock.set_clock_source(SystClkSource::Core);
        clock.set_reload(0x00ff_ffff);
        clock.clear_current();
        clock.enable_counter();

        let rooms = cortex_m::singleton!(: [Room; 2] = [[[0.0; N]; 2]; 2]).expect("taken once");
        let mut sound = true;
        hprintln!("controller {} B", size_of::<Arm>());
        for ((family, golden), room) in GOLDEN.into_iter().zip(rooms) {
            let start = arm(family, room).expect("a sound policy");

            let print = Fingerprint::of(&mut { start }, UPDATES);

            let (mut arm, mut worst, mut sum) = (start, 0, 0_u64);
            let low = paint();
            for tick in 0..UPDATES {
                let ticks = timed(&mut arm, tick);
                worst = worst.max(ticks);
                sum += u64::from(ticks);
            }
            let stack = used(low);
            let mean = instructions((sum / u64::from(UPDATES)) as u32);
            let worst = instructions(worst);
            hprintln!("{:?} family: {} instructions per update, at most {}, stack {} B", family, mean, worst, stack);
            hprintln!("  bits {:#018x}, on the host {:#018x}", print.0, golden);
            sound &= print.0 == golden && worst <= bound(family) && stack <= STACK_BOUND;
        }
        for (family, golden) in DOUBLE_GOLDEN {
            let mut arm = double_arm(family).expect("a sound policy");
            let print = Fingerprint::of(&mut arm, DOUBLE_UPDATES);
            hprintln!("{:?} family in f64: bits {:#018x}, on the host {:#018x}", family, print.0, golden);
            sound &= print.0 == golden;
        }
        hprintln!("{}", if sound { "sound" } else { "FAILED" });
        debug::exit(if sound { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
        loop {
            cortex_m::asm::wfi();
        }
    }
}
