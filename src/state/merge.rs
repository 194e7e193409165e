//! Merges ascending lists.

/// Calls `f` in order with the elements of two lists that ascend by `order`. Of equal elements, the first list's comes
/// first.
pub(crate) fn merge<T, K: Ord>(
    [one, other]: [impl Iterator<Item = T>; 2],
    order: impl Fn(&T) -> K,
    mut f: impl FnMut(T),
) {
    let (mut one, mut other) = (one.peekable(), other.peekable());
    loop {
        let is_first = match (one.peek(), other.peek()) {
            (Some(a), Some(b)) => order(a) <= order(b),
            (a, _) => a.is_some(),
        };
        match if is_first { one.next() } else { other.next() } {
            Some(next) => f(next),
            None => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_merged_in_order() {
        let mut all = Vec::new();
        let lists: [&[(i32, char)]; 2] = [&[(1, 'a'), (3, 'a'), (3, 'b')], &[(0, 'c'), (3, 'c')]];
        merge(
            lists.map(|list| list.iter().copied()),
            |&(key, _)| key,
            |element| all.push(element),
        );
        assert_eq!(all, [(0, 'c'), (1, 'a'), (3, 'a'), (3, 'b'), (3, 'c')]);
    }
}
