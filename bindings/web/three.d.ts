import type { AnimationClip, AnimationMixer, LineSegments, Material, Object3D, SkinnedMesh } from 'three';
import type { Live, Skin } from './lorica.js';

export function skinOf(mesh: SkinnedMesh, poses?: Float64Array): Skin;
export function bonesOf(mesh: SkinnedMesh, out?: Float64Array): Float64Array;
export function posesOf(mesh: SkinnedMesh, root: Object3D, mixer: AnimationMixer, clips: AnimationClip[], count?: number): Float64Array;
export function hullLines(THREE: typeof import('three'), live: Live, material?: Material): { lines: LineSegments; update(): void };
