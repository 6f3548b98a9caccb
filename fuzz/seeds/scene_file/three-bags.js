// The room of empty-35x35.js with three pieces of luggage in it, one of them two cells wide; and what no hall can say:
// something that moves, and two sonars.
const config = {
    floor: { size: { x: 35, y: 35 } },
    player: { position: { x: .08, y: .08 }, speed: .2 },
    sonars: [
        { name: "sonar1", position: { x: .46, y: .02 }, senseAxis: { x: false, y: true } },
        { name: "sonar2", position: { x: .02, y: .80 }, senseAxis: { x: true, y: false } },
    ],
    movingObstacles: [
        { name: "cart", position: { x: .5, y: .4 }, directionAxis: { x: true, y: false }, speed: 1, range: 4 },
    ],
    staticObstacles: [
        { name: "suitcase",  centerPosition: { x: .423, y: .691 }, size: { x: .04, y: .04 } },
        { name: "box1",      centerPosition: { x: .766, y: .463 }, size: { x: .04, y: .04 } },
        { name: "trolley",   centerPosition: { x: .251, y: .234 }, size: { x: .16, y: .04 } },
        { name: "wallUp",    centerPosition: { x: .5,   y: .995 }, size: { x: 1,   y: .01 } },
        { name: "wallDown",  centerPosition: { x: .5,   y: .005 }, size: { x: 1,   y: .01 } },
        { name: "wallLeft",  centerPosition: { x: .005, y: .5   }, size: { x: .01, y: 1   } },
        { name: "wallRight", centerPosition: { x: .995, y: .5   }, size: { x: .01, y: 1   } },
    ],
};

export default config;
