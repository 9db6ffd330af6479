import { Raycaster, Vector2 } from 'three';
import { toLocal } from './matrices.js';

const raycaster = new Raycaster();

/** The ray through a pixel of the page. @returns {import('three').Ray} */
export function rayAt(camera, canvas, { clientX, clientY }) {
  const { left, top, width, height } = canvas.getBoundingClientRect();
  const at = new Vector2(((clientX - left) / width) * 2 - 1, 1 - ((clientY - top) / height) * 2);
  raycaster.setFromCamera(at, camera);
  return raycaster.ray;
}

/**
 * The nearest body under the pointer.
 * @returns {?{node: Object, point: Vector3, local: number[]}} point in the scene, local in the body
 */
export function pick(view, camera, canvas, pointer) {
  rayAt(camera, canvas, pointer);
  const [hit] = raycaster.intersectObjects(view.targets(), false);
  if (!hit) return null;
  const id = hit.owner.node;
  return { node: view.node(id), point: hit.point, local: toLocal(view.pose(id), hit.point.toArray()) };
}
