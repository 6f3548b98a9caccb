// An empty room for the virtual robot's page: 35 × 35 units, which are 8 × 8 cells of the robot's size, with a wall on each side.
const config = {
    floor: { size: { x: 35, y: 35 } },
    player: { position: { x: .08, y: .08 }, speed: .2 },   // near the north-west corner
    sonars: [],
    movingObstacles: [],
    staticObstacles: [
        { name: "wallUp",    centerPosition: { x: .5,   y: .995 }, size: { x: 1,   y: .01 } },
        { name: "wallDown",  centerPosition: { x: .5,   y: .005 }, size: { x: 1,   y: .01 } },
        { name: "wallLeft",  centerPosition: { x: .005, y: .5   }, size: { x: .01, y: 1   } },
        { name: "wallRight", centerPosition: { x: .995, y: .5   }, size: { x: .01, y: 1   } },
    ],
};

export default config;
