// Types of the npm package, for editors and TypeScript: engine.js has the functions.
export type Point = [number, number, number];

/** Groups and names of parameters as in a report: docs/reference/options.md. */
export type Parameters = Record<string, Record<string, unknown>>;

export interface Summary {
  samples: number;
  /** Input units; 0: none fits into the memory of the parameters. */
  smallest_voxel: number;
  scans: number;
  spacing: number;
  normals: boolean;
  colors: boolean;
  coordinate_system: string;
  box: {lo: Point; hi: Point};
}

export interface Mesh<Positions = Float32Array> {
  /** x, y, z of each vertex: of mesh(), around the origin that was asked for. */
  positions: Positions;
  /** Three vertices for each triangle. */
  indices: Uint32Array;
  /** x, y, z of each vertex. */
  normals: Float32Array | null;
  /** r, g, b, 255 of each vertex. */
  colors: Uint8Array | null;
  attributes: {name: string; values: Float32Array}[];
}

/** A closed or open 2-manifold. */
export interface GivenMesh<Positions = ArrayLike<number>> {
  positions: Positions;
  indices: ArrayLike<number>;
  normals?: ArrayLike<number> | null;
  /** Three or four values in [0, 255] of each vertex. */
  colors?: ArrayLike<number> | null;
  attributes?: {name: string; values: ArrayLike<number>}[];
}

/** Greatest distance between old and new mesh, in both directions, in the units of the mesh; or so many triangles. */
export type SimplifyTarget = {tolerance: number} | {triangles: number};

export interface SimplifyReport {
  triangles_before: number;
  triangles: number;
  tolerance: number;
  /** No point of either mesh is farther than this from the other. */
  proved: number;
}

export interface Engine {
  version(): string;
  /** A file's bytes, under its name. */
  put(name: string, bytes: Uint8Array): void;
  /** What was put under that name becomes part of the cloud. */
  read(name: string): void;
  /** Gives the memory of a file back. */
  forget(name: string): void;
  summary(parameters?: Parameters): Summary;
  /** At most so many of the samples, around the origin. */
  preview(most: number, origin: Point): {positions: Float32Array; colors: Uint8Array | null};
  /** Computes until it is done. Throws an Error with one line that says what is refused. */
  reconstruct(parameters: Parameters): void;
  mesh(origin: Point): Mesh;
  /**
   * Fewer triangles, within a proved distance, of arrays, of a mesh file that was put under a name, or, by null, of the
   * engine's own mesh. The engine has the smaller one afterwards: write() writes it.
   */
  simplify(
    mesh: GivenMesh<Float32Array>,
    target: SimplifyTarget,
  ): {mesh: Mesh<Float32Array>; report: SimplifyReport};
  simplify(
    mesh: GivenMesh | string | null,
    target: SimplifyTarget,
  ): {mesh: Mesh<Float64Array>; report: SimplifyReport};
  /** JSON: of reconstruct() or simplify(), which was last. */
  report(): string;
  /** The mesh as bytes of a file: .ply .glb .obj .stl. */
  write(name: string): Uint8Array;
  /** Bytes in use. */
  memory(): number;
}

/** A new engine, for one run. */
export function engine(
  onEvent?: (kind: 'stage' | 'advance' | 'info' | 'warning', fraction: number, text: string) => void,
): Promise<Engine>;
