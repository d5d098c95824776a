//! A stack of fixed size that costs nothing to make.

use core::mem::MaybeUninit;

/// The memory of a [`Stack`]: apart from it, so that the compiler keeps its length in a register. Making one does not
/// write its memory.
#[derive(Debug)]
pub struct Room<const N: usize> {
    /// So many items were written.
    length: usize,
    items: [MaybeUninit<u64>; N],
}

impl<const N: usize> Default for Room<N> {
    #[inline(always)]
    fn default() -> Self {
        Room { length: 0, items: [const { MaybeUninit::uninit() }; N] }
    }
}

impl<const N: usize> Room<N> {
    /// The stack as it was [left](Stack::leave) last, or an empty one.
    #[inline(always)]
    pub fn enter(&mut self) -> Stack<'_, N> {
        Stack { length: self.length, left: &mut self.length, items: &mut self.items }
    }
}

/// At most `N` numbers, last in, first out.
#[derive(Debug)]
pub struct Stack<'a, const N: usize> {
    length: usize,
    left: &'a mut usize,
    items: &'a mut [MaybeUninit<u64>; N],
}

impl<const N: usize> Stack<'_, N> {
    /// Keeps the items for the next [`enter`](Room::enter).
    #[inline(always)]
    pub fn leave(self) {
        *self.left = self.length;
    }

    /// The number of items.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.length
    }

    /// Whether there is none.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// Removes all items.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.length = 0;
    }

    /// Puts an item on top; ignored when the stack is full (its owner proves that this does not happen).
    #[inline(always)]
    pub fn push(&mut self, item: u64) {
        debug_assert!(self.length < N);
        if self.length < N {
            self.items[self.length] = MaybeUninit::new(item);
            self.length += 1;
        }
    }

    /// Takes the top item.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<u64> {
        if self.length == 0 {
            return None;
        }
        self.length -= 1;
        // SAFETY: the first `length` items were written by `push` or `insert_descending` before `length` was
        // raised above them: `length` began at 0, or where another stack in this room left it.
        self.items.get(self.length).map(|item| unsafe { item.assume_init() })
    }

    /// The top item.
    #[inline(always)]
    pub fn top(&self) -> Option<u64> {
        // SAFETY: as in `pop`.
        self.items[..self.length.min(N)].last().map(|item| unsafe { item.assume_init() })
    }

    /// Puts an item into place, given that the items from `base` on are in descending order, so that the smallest
    /// stays on top.
    #[inline(always)]
    pub fn insert_descending(&mut self, base: usize, item: u64) {
        debug_assert!(base <= self.length && self.length < N);
        if self.length >= N {
            return;
        }
        let mut at = self.length;
        while at > base {
            // SAFETY: `at - 1 < length`: written by `push`, as in `pop`.
            let below = unsafe { self.items[at - 1].assume_init() };
            if below >= item {
                break;
            }
            self.items[at] = MaybeUninit::new(below);
            at -= 1;
        }
        self.items[at] = MaybeUninit::new(item);
        self.length += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inserts_in_descending_order_above_the_base() {
        let mut room = Room::<8>::default();
        let mut stack = room.enter();
        stack.push(1);
        for item in [5, 9, 2, 7] {
            stack.insert_descending(1, item);
        }
        assert_eq!(stack.top(), Some(2));
        stack.leave();
        let mut stack = room.enter();
        let popped: Vec<u64> = core::iter::from_fn(|| stack.pop()).collect();
        assert_eq!(popped, [2, 5, 7, 9, 1]);
        assert!(stack.is_empty());
    }
}
