//! Large arrays on large pages, and memory asked for ahead of time.

use alloc::vec::Vec;

/// Asks for the first cache lines of a value that will be needed soon. Has no effect but on time.
#[inline(always)]
pub fn prefetch<T>(value: &T) {
    prefetch_lines(value, 4);
}

/// Asks for as many of the first cache lines of a value.
#[inline(always)]
pub fn prefetch_lines<T>(value: &T, most: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let start = (value as *const T).cast::<i8>();
        for line in 0..core::mem::size_of::<T>().div_ceil(64).min(most) {
            // SAFETY: every x86-64 has the instruction, which never faults; the address lies within `value`.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(64 * line)) }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (value, most);
}

/// An empty vector with room for `capacity` items. On Linux the kernel is asked to back a large one with huge pages,
/// which spares a page walk at each visit of a random place. Only time depends on it.
pub fn vec_on_large_pages<T>(capacity: usize) -> Vec<T> {
    let vec = Vec::<T>::with_capacity(capacity);
    #[cfg(all(target_os = "linux", feature = "std"))]
    advise(vec.as_ptr().cast(), vec.capacity().saturating_mul(core::mem::size_of::<T>()));
    vec
}

/// `madvise(MADV_HUGEPAGE)` for the whole pages of this range of memory.
#[cfg(all(target_os = "linux", feature = "std"))]
fn advise(start: *const u8, bytes: usize) {
    use core::ffi::{c_int, c_void};
    // From the C library that `std` is linked with.
    unsafe extern "C" {
        fn madvise(address: *mut c_void, length: usize, advice: c_int) -> c_int;
    }
    // Both are parts of Linux's binary interface, the same on all its processors that Rust supports.
    const MADV_HUGEPAGE: c_int = 14;
    const HUGE: usize = 2 << 20;
    // The start of a huge page is the start of a page of any size.
    let skip = start.align_offset(HUGE);
    if skip >= bytes || bytes - skip < HUGE {
        return;
    }
    let length = (bytes - skip) / HUGE * HUGE;
    // SAFETY: the range lies inside an allocation that we own. This advice changes no byte of it, and a failure
    // (ignored) leaves all as it was.
    unsafe { madvise(start.wrapping_add(skip).cast_mut().cast(), length, MADV_HUGEPAGE) };
}
