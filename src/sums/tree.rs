//! A fixed order of floating-point sums, however a run is divided: the binary tree over block
//! numbers.
//!
//! Block k is leaf k. Node (level l, index i) is the sum of the blocks i 2^l .. (i + 1) 2^l, and is
//! formed by merging its left half with its right half. A part of a run keeps the largest nodes all
//! of whose blocks it has, O(log n) of them for n consecutive blocks, and nothing else. Parts are
//! joined by putting their nodes together. The sum of the blocks that are there is the root of the
//! tree in which the missing blocks are empty leaves. Merging with nothing changes no bit, so this
//! sum does not depend on which part computed which block, and when.
//!
//! Pairwise summation is also more accurate than one running sum: its rounding error grows like the
//! depth of the tree, log2 n, instead of like n in the worst case (N. J. Higham, *The accuracy of
//! floating point summation*, SIAM J. Sci. Comput. 14 (1993)).

use super::codec::{Codec, Damaged, Reader};
use super::merge::Merge;
use std::collections::BTreeMap;

/// The error when a block is in both of two parts that are to be joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("block {block} is in both parts")]
pub struct Overlap {
    /// The lowest such block.
    pub block: u64,
}

/// The sums of some blocks of a run: the complete nodes, by the numbers of their first blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree<S> {
    nodes: BTreeMap<u64, Subtree<S>>,
}

#[derive(Clone, Debug, PartialEq)]
struct Subtree<S> {
    level: u32,
    sums: S,
}

impl<S> Default for Tree<S> {
    fn default() -> Self {
        Tree {
            nodes: BTreeMap::new(),
        }
    }
}

impl<S: Merge> Tree<S> {
    /// Add one block. Fails if the block has already been added.
    pub fn push(&mut self, block: u64, sums: S) -> Result<(), Overlap> {
        self.insert(block, Subtree { level: 0, sums })
    }

    /// Add the blocks of another part. Fails if both parts have the same block; then this part
    /// remains unchanged.
    pub fn merge(&mut self, other: Tree<S>) -> Result<(), Overlap> {
        // This is checked first, so that this part is unchanged after an error.
        let there = other
            .nodes
            .iter()
            .find_map(|(first, node)| self.first_in(*first, size(node.level)));
        match there {
            Some(block) => Err(Overlap { block }),
            None => other
                .nodes
                .into_iter()
                .try_for_each(|(first, node)| self.insert(first, node)),
        }
    }

    fn insert(&mut self, mut first: u64, mut node: Subtree<S>) -> Result<(), Overlap> {
        if let Some(block) = self.first_in(first, size(node.level)) {
            return Err(Overlap { block });
        }
        loop {
            let sibling = first ^ size(node.level);
            if self
                .nodes
                .get(&sibling)
                .is_none_or(|other| other.level != node.level)
            {
                break;
            }
            let Some(other) = self.nodes.remove(&sibling) else {
                break;
            };
            let (mut left, right) = if sibling < first {
                (other, node)
            } else {
                (node, other)
            };
            left.sums.merge(&right.sums);
            (first, node) = (
                first.min(sibling),
                Subtree {
                    level: left.level + 1,
                    sums: left.sums,
                },
            );
        }
        self.nodes.insert(first, node);
        Ok(())
    }

    /// The first block of `first .. first + blocks` that has already been added.
    fn first_in(&self, first: u64, blocks: u64) -> Option<u64> {
        let before = self.nodes.range(..first).next_back();
        let reaches = before
            .filter(|(start, node)| *start + size(node.level) > first)
            .map(|_| first);
        reaches.or_else(|| {
            self.nodes
                .range(first..first + blocks)
                .next()
                .map(|(start, _)| *start)
        })
    }

    /// The blocks that have been added, as ranges without gaps, in ascending order.
    pub fn ranges(&self) -> Vec<std::ops::Range<u64>> {
        let mut ranges: Vec<std::ops::Range<u64>> = Vec::new();
        for (&first, node) in &self.nodes {
            let end = first + size(node.level);
            match ranges.last_mut() {
                Some(last) if last.end == first => last.end = end,
                _ => ranges.push(first..end),
            }
        }
        ranges
    }

    /// The sum over all blocks of what `part` selects from their sums; none if there are no blocks.
    ///
    /// The order of merging is that of the whole sums, so that the result is the same part of their
    /// total.
    pub fn total<P: Merge + Clone>(&self, part: impl Fn(&S) -> &P) -> Option<P> {
        let nodes: Vec<(u64, &P)> = self
            .nodes
            .iter()
            .map(|(first, node)| (*first, part(&node.sums)))
            .collect();
        root(&nodes, u64::BITS)
    }
}

/// Number of blocks of a node.
fn size(level: u32) -> u64 {
    1 << level
}

/// The sum of nodes that all lie within one node of this level.
fn root<P: Merge + Clone>(nodes: &[(u64, &P)], level: u32) -> Option<P> {
    match nodes {
        [] => None,
        [(_, only)] => Some((*only).clone()),
        _ => {
            let bit = level - 1;
            let right = nodes.partition_point(|(first, _)| first >> bit & 1 == 0);
            match (root(&nodes[..right], bit), root(&nodes[right..], bit)) {
                (Some(mut left), Some(right)) => {
                    left.merge(&right);
                    Some(left)
                }
                (left, right) => left.or(right),
            }
        }
    }
}

impl<S> Tree<S> {
    /// Append the nodes: their number, and for each the level, the first block, and what `part`
    /// selects from its sums.
    pub fn write<P: Codec>(&self, out: &mut Vec<u8>, part: impl Fn(&S) -> &P) {
        (self.nodes.len() as u64).write(out);
        for (first, node) in &self.nodes {
            u64::from(node.level).write(out);
            first.write(out);
            part(&node.sums).write(out);
        }
    }
}

impl<S: Merge + Clone> Tree<S> {
    /// Read the nodes back, each into `part` of a copy of `empty`. The bytes are damaged if nodes
    /// overlap, if a node is at a wrong place, or if two nodes should be one.
    pub fn read<P: Codec>(
        from: &mut Reader<'_>,
        empty: &S,
        part: impl Fn(&mut S) -> &mut P,
    ) -> Result<Self, Damaged> {
        let mut tree = Tree::default();
        let count = from.length()?;
        for _ in 0..count {
            let [level, first]: [u64; 2] = from.value()?;
            let mut sums = empty.clone();
            part(&mut sums).read(from)?;
            let level = u32::try_from(level)
                .ok()
                .filter(|level| *level < u64::BITS - 1)
                .ok_or(Damaged)?;
            if first % size(level) != 0 || first > u64::MAX / 2 {
                return Err(Damaged);
            }
            tree.insert(first, Subtree { level, sums })
                .map_err(|_| Damaged)?;
        }
        if tree.nodes.len() == count {
            Ok(tree)
        } else {
            Err(Damaged)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::Moments;
    use proptest::prelude::*;
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::{Rng, SeedableRng};

    fn blocks(n: u64, seed: u64) -> Vec<Moments> {
        let mut rng = Pcg64Dxsm::seed_from_u64(seed);
        let mut value = || (rng.next_u64() >> 11) as f64 * 2f64.powi(-53);
        (0..n)
            .map(|_| Moments::of(&[value(), 10.0 * value(), -3.0 * value()]))
            .collect()
    }

    fn whole(blocks: &[Moments]) -> Moments {
        let mut tree = Tree::default();
        (0..)
            .zip(blocks)
            .for_each(|(k, block)| tree.push(k, *block).expect("each block once"));
        tree.total(|sums| sums).expect("there are blocks")
    }

    /// The sum by its definition, without the code under test: halves of a power of two of leaves,
    /// where missing leaves are empty.
    fn by_definition(blocks: &[Moments], first: usize, size: usize) -> Moments {
        if size == 1 {
            return blocks.get(first).copied().unwrap_or_default();
        }
        let mut left = by_definition(blocks, first, size / 2);
        left.merge(&by_definition(blocks, first + size / 2, size / 2));
        left
    }

    fn bits(m: &Moments) -> (u64, u64, u64) {
        (m.count, m.mean.to_bits(), m.m2.to_bits())
    }

    proptest! {
        #[test]
        fn any_cut_completed_in_any_order_has_the_bits_of_the_whole(
            n in 1_u64..300,
            cuts in prop::collection::vec(0.0..1.0f64, 0..12),
            order in any::<u64>(),
            through_bytes in any::<bool>(),
        ) {
            let blocks = blocks(n, order);
            let mut ends: Vec<u64> = cuts.iter().map(|cut| (cut * n as f64) as u64).collect();
            ends.extend([0, n]);
            ends.sort_unstable();
            let mut parts: Vec<Tree<Moments>> = ends.windows(2).map(|cut| {
                let mut part = Tree::default();
                (cut[0]..cut[1]).for_each(|k| part.push(k, blocks[k as usize]).expect("each block once"));
                part
            }).collect();
            let mut rng = Pcg64Dxsm::seed_from_u64(order);
            let mut joined = Tree::default();
            while !parts.is_empty() {
                let mut part = parts.swap_remove(rng.next_u64() as usize % parts.len());
                if through_bytes {
                    let mut bytes = Vec::new();
                    part.write(&mut bytes, |sums| sums);
                    part = Tree::read(&mut Reader::new(&bytes), &Moments::default(), |sums| sums).expect("as written");
                }
                joined.merge(part).expect("the parts do not overlap");
            }
            prop_assert_eq!(joined.ranges(), vec![0..n]);
            prop_assert!(joined.nodes.len() as u32 <= u64::BITS - n.leading_zeros());
            let total = joined.total(|sums| sums).expect("there are blocks");
            prop_assert_eq!(bits(&total), bits(&whole(&blocks)));
            prop_assert_eq!(bits(&total), bits(&by_definition(&blocks, 0, 512)));
        }

        #[test]
        fn a_range_anywhere_takes_no_more_than_two_nodes_a_level(first in 0_u64..1 << 40, n in 1_u64..2000) {
            let mut part = Tree::default();
            (first..first + n).for_each(|k| part.push(k, Moments::default()).expect("each block once"));
            prop_assert!(part.nodes.len() as u32 <= 2 * (u64::BITS - n.leading_zeros()));
            prop_assert_eq!(part.ranges(), vec![first..first + n]);
        }
    }

    #[test]
    fn a_block_that_is_there_already_is_refused() {
        let mut tree = Tree::default();
        (4..8).for_each(|k| {
            tree.push(k, Moments::of(&[k as f64]))
                .expect("each block once")
        });
        assert_eq!(tree.nodes.len(), 1);
        for k in 4..8 {
            assert_eq!(
                tree.clone().push(k, Moments::default()),
                Err(Overlap { block: k })
            );
        }
        let mut other = Tree::default();
        (0..5).for_each(|k| other.push(k, Moments::default()).expect("each block once"));
        let before = other.clone();
        assert_eq!(other.merge(tree), Err(Overlap { block: 4 }));
        assert_eq!(other, before);
    }

    #[test]
    fn nodes_that_are_not_those_of_a_tree_are_damage() {
        let bytes_of = |nodes: &[(u64, u64)]| {
            let mut bytes = Vec::new();
            (nodes.len() as u64).write(&mut bytes);
            for (level, first) in nodes {
                level.write(&mut bytes);
                first.write(&mut bytes);
                Moments::of(&[1.0]).write(&mut bytes);
            }
            bytes
        };
        let read =
            |bytes: &[u8]| Tree::read(&mut Reader::new(bytes), &Moments::default(), |sums| sums);
        assert!(read(&bytes_of(&[(2, 4), (0, 8)])).is_ok());
        for nodes in [
            &[(2, 5)][..],
            &[(2, 4), (0, 6)],
            &[(0, 4), (0, 5)],
            &[(63, 0)],
            &[(0, u64::MAX)],
        ] {
            assert_eq!(read(&bytes_of(nodes)), Err(Damaged), "{nodes:?}");
        }
        let bytes = bytes_of(&[(2, 4), (0, 8)]);
        for cut in 0..bytes.len() {
            assert_eq!(read(&bytes[..cut]), Err(Damaged), "{cut}");
        }
    }

    /// The mean over 2^16 blocks, compared with a sum in twice the precision. The error of a
    /// running mean grows with the number of merges, that of the tree with its depth, 16.
    #[test]
    fn the_tree_rounds_less_than_a_running_sum() {
        let blocks = blocks(1 << 16, 3);
        // Neumaier's sum is as accurate as if computed in twice the precision, so it is exact at
        // this scale.
        let (mut sum, mut lost) = (0.0_f64, 0.0_f64);
        for term in blocks.iter().map(|block| block.mean) {
            let next = sum + term;
            lost += if sum.abs() >= term.abs() {
                (sum - next) + term
            } else {
                (term - next) + sum
            };
            sum = next;
        }
        let exact = (sum + lost) / blocks.len() as f64;
        let mut running = Moments::default();
        blocks.iter().for_each(|block| running.merge(block));
        let error = |mean: f64| ((mean - exact) / exact).abs() / f64::EPSILON;
        let (tree, running) = (error(whole(&blocks).mean), error(running.mean));
        println!(
            "relative error of a mean over 65 536 blocks, in units of 2^-52: tree {tree:.2}, running {running:.2}"
        );
        // Each of 16 levels rounds by about half a unit, in either direction.
        assert!(tree <= 4.0 && tree <= running, "{tree} {running}");
    }
}
