import type { Live, Parts } from './lorica.js';

/** The engines' own types are theirs: `engine` is what their package exports. */
type Of = any;
/** rapier: a world, a description of the body. cannon: a world, a mass. */
export function addParts(engine: Of, world: Of, parts: Parts, how?: Of): Of;
/** rapier, cannon: a world. jolt: a BodyInterface, and the layer of the bodies. */
export function followLive(engine: Of, world: Of, live: Live, layer?: number): { update(): void; body?: Of; bodies?: Of; parts?: Map<number, number> };
/** jolt: positions and how many. cannon: a hull. */
export function hullShape(engine: Of, hull: Of, count?: number): Of;
/** jolt: the hulls of parts as one shape. */
export function partsShape(engine: Of, parts: Parts): Of;
