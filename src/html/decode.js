// Meshes as src/pipeline/html_encode.h writes them, back into arrays.

async function inflated(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Tuples of 16-bit numbers: differences, zigzag coded, in planes of low and high bytes of each channel.
function unpackedTuples(bytes, channels) {
  const n = bytes.length / (2 * channels);
  const values = new Uint16Array(n * channels);
  for (let c = 0; c < channels; ++c) {
    const low = 2 * c * n, high = low + n;
    let value = 0;
    for (let i = 0; i < n; ++i) {
      const code = bytes[low + i] | bytes[high + i] << 8;
      value = value + ((code >>> 1) ^ -(code & 1)) & 0xffff;
      values[i * channels + c] = value;
    }
  }
  return values;
}

// Each number tells how far an index is below the least one that was not used yet.
function unpackedIndices(bytes, count) {
  const indices = new Uint32Array(count);
  let at = 0, next = 0;
  for (let i = 0; i < count; ++i) {
    let below = 0, shift = 0, byte;
    do {
      byte = bytes[at++];
      below |= (byte & 127) << shift;
      shift += 7;
    } while (byte & 128);
    indices[i] = next - below;
    if (below === 0) ++next;
  }
  return indices;
}

async function decodedMesh(mesh) {
  const [positions, indices] = await Promise.all([inflated(mesh.positions), inflated(mesh.indices)]);
  return {positions: unpackedTuples(positions, 3), indices: unpackedIndices(indices, 3 * mesh.facets)};
}

// Shares of the largest distance, as 16-bit numbers with a sign.
async function decodedValues(values) {
  return new Int16Array(unpackedTuples(await inflated(values), 1).buffer);
}
