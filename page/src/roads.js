import { BufferGeometry, Float32BufferAttribute, Mesh, MeshLambertMaterial, Vector3 } from 'three';

const LINE = 0.14; // m wide
const INSET = 0.3; // m from the edge of the road
const LIFT = 0.02; // m over the road
const DASH = 2; // points of the centre line that a dash, and a gap, is long
const UP = new Vector3(0, 1, 0);

/** Markings of the roads of a scene: a line along each edge and a dashed one in the middle. */
export function roadMarkings(roads) {
  const positions = [];
  for (const road of roads) addRoad(positions, road);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(positions, 3));
  geometry.computeVertexNormals();
  const material = new MeshLambertMaterial({
    color: 0xe9e7df,
    polygonOffset: true,
    polygonOffsetFactor: -4,
    polygonOffsetUnits: -4,
  });
  const mesh = new Mesh(geometry, material);
  mesh.receiveShadow = true;
  return mesh;
}

function addRoad(positions, { points, width, closed }) {
  const places = points.map((point) => new Vector3(...point));
  const count = places.length;
  const at = (i) => places[closed ? (i + count) % count : Math.min(Math.max(i, 0), count - 1)];
  const aside = (i) =>
    at(i + 1)
      .clone()
      .sub(at(i - 1))
      .cross(UP)
      .normalize();
  const edge = width / 2 - INSET;
  for (let i = 0; i < (closed ? count : count - 1); ++i) {
    const offsets = i % (2 * DASH) < DASH ? [-edge, 0, edge] : [-edge, edge];
    for (const offset of offsets) addStrip(positions, [at(i), aside(i)], [at(i + 1), aside(i + 1)], offset);
  }
}

/** A strip from one cross section of the road to the next, so far from its middle. */
function addStrip(positions, from, to, offset) {
  const corner = ([point, aside], across) => {
    const { x, y, z } = point.clone().addScaledVector(aside, offset + across);
    return [x, y + LIFT, z];
  };
  const [a, b] = [corner(from, -LINE / 2), corner(from, LINE / 2)];
  const [c, d] = [corner(to, -LINE / 2), corner(to, LINE / 2)];
  positions.push(...a, ...b, ...c, ...c, ...b, ...d);
}
