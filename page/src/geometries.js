import { BoxGeometry, BufferGeometry, CapsuleGeometry, Float32BufferAttribute, SphereGeometry } from 'three';
import { mergeVertices, toCreasedNormals } from 'three/addons/utils/BufferGeometryUtils.js';

const CREASE = 0.6; // rad; edges sharper than this stay sharp
const LARGEST_CREASED = 4000; // triangles; beyond, as on hills, all edges are smooth

/**
 * What to draw for a geometry of the scene message: an indexed geometry of three.js and the scale that it takes. Boxes
 * and spheres of all sizes share one geometry and so one draw call.
 * @returns {{key: string, scale: number[], size: number, make: function(boolean): BufferGeometry}} size: half of the longest
 * side, m; `make` takes whether there are so many that a coarse one will do
 */
export function describeGeometry(geometry, index) {
  switch (geometry.kind) {
    case 'box':
      return {
        key: 'box',
        scale: geometry.half,
        size: Math.max(...geometry.half),
        make: () => new BoxGeometry(2, 2, 2),
      };
    case 'sphere':
      return { key: 'sphere', scale: Array(3).fill(geometry.radius), size: geometry.radius, make: ball };
    case 'capsule':
      return {
        key: `capsule ${geometry.radius} ${geometry.halfHeight}`,
        scale: [1, 1, 1],
        size: geometry.radius + geometry.halfHeight,
        make: (many) => new CapsuleGeometry(geometry.radius, 2 * geometry.halfHeight, many ? 2 : 5, many ? 8 : 16),
      };
    case 'mesh':
      return {
        key: `mesh ${index}`,
        scale: [1, 1, 1],
        size: extent(geometry.positions) / 2,
        make: () => meshGeometry(geometry),
      };
    default:
      throw new Error(`a geometry of unknown kind "${geometry.kind}"`);
  }
}

function ball(many) {
  return many ? new SphereGeometry(1, 12, 8) : new SphereGeometry(1, 24, 16);
}

/** The longest side of the box around the points. */
function extent(positions) {
  const least = [Infinity, Infinity, Infinity];
  const most = [-Infinity, -Infinity, -Infinity];
  positions.forEach((value, i) => {
    least[i % 3] = Math.min(least[i % 3], value);
    most[i % 3] = Math.max(most[i % 3], value);
  });
  return Math.max(...most.map((value, i) => value - least[i]));
}

function meshGeometry({ positions, indices }) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(positions, 3));
  geometry.setIndex(indices);
  return withNormals(geometry);
}

/** The geometry, indexed and with normals: sharp edges stay sharp, the others are smoothed. */
export function withNormals(geometry) {
  if (geometry.index && geometry.attributes.normal) return geometry;
  if (geometry.attributes.normal) return mergeVertices(geometry);
  geometry.computeVertexNormals();
  const corners = (geometry.index ?? geometry.attributes.position).count;
  return corners <= 3 * LARGEST_CREASED ? mergeVertices(toCreasedNormals(geometry, CREASE)) : geometry;
}
