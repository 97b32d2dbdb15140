// Reads the data of the page: the length of the description, the description as JSON, and binary
// data with streams of integers (src/html/stream.rs) and images.

export function read(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const description = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  return { description, binary: new Uint8Array(buffer, 4 + length) };
}

export const PREVIOUS = 1;
export const LINE = 2;

/** Returns `number` channels of `count` integers each from a stream. */
export function channels(binary, [offset, length], number, count, prediction) {
  let at = offset;
  const varint = () => {
    let value = 0;
    for (let scale = 1; ; scale *= 128) {
      const byte = binary[at++];
      value += (byte & 127) * scale;
      if (byte < 128) return value % 2 ? -(value + 1) / 2 : value / 2;
    }
  };
  const all = [];
  for (let channel = 0; channel < number; channel++) {
    const values = new Float64Array(count);
    for (let i = 0; i < count; i++) {
      const previous = i > 0 ? values[i - 1] : 0;
      const predicted = prediction === LINE && i > 1 ? 2 * previous - values[i - 2] : previous;
      values[i] = predicted + varint();
    }
    all.push(values);
  }
  if (at !== offset + length) throw new Error('the data of the page are damaged');
  return all;
}

/** Converts the integers of an interval to values. */
export const scaled = (integers, { low, step }) => Float32Array.from(integers, (n) => low + step * n);
