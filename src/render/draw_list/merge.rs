//! Draw calls of several images.

use super::{Batch, DrawCalls, push};

/// Collects the draw calls of several images, so that batches of different images with equal keys
/// become one. `lists` are the calls of the images in order; each instance gets the index of its
/// image. The calls of each image remain in their order.
pub(crate) fn merge(lists: &[&DrawCalls], merged: &mut DrawCalls) {
    merged.clear();
    let DrawCalls { instances, reflector, opaque, transparent, front_to_back, marks } = merged;
    let mut add = |image: usize, batch: &Batch, batches: &mut Vec<Batch>| {
        for instance in &lists[image].instances[batch.instances.start as usize..batch.instances.end as usize] {
            let instance = super::Instance { view: image as u32, ..*instance };
            push(batches, instances, (batch.key, batch.visibility, batch.order), instance);
        }
    };
    let all = |of: fn(&DrawCalls) -> &[Batch]| {
        lists.iter().enumerate().flat_map(move |(image, list)| of(list).iter().map(move |batch| (image, batch)))
    };
    let mut sorted: Vec<(usize, &Batch)> = all(|list| &list.opaque).collect();
    sorted.sort_by_key(|(_, batch)| (batch.order, batch.key, batch.visibility));
    all(|list| &list.reflector).for_each(|(image, batch)| add(image, batch, reflector));
    for (image, batch) in sorted {
        add(image, batch, opaque);
    }
    all(|list| &list.transparent[..list.front_to_back]).for_each(|(image, batch)| add(image, batch, transparent));
    let mut back_to_front = Vec::new();
    all(|list| &list.transparent[list.front_to_back..])
        .for_each(|(image, batch)| add(image, batch, &mut back_to_front));
    *front_to_back = transparent.len();
    transparent.append(&mut back_to_front);
    all(|list| &list.marks).for_each(|(image, batch)| add(image, batch, marks));
}
