//! A second interpreter, as simple as possible: every node owns its children and its memory, and does what the node of
//! its name does in BehaviorTree.CPP 4. It has no ports and no scripts, and is slow.

use std::collections::BTreeSet;

use behaviour_trees::{Element, Status};

#[derive(Default)]
pub(crate) struct World {
    pub(crate) clock_ms: u64,
    pub(crate) halted: Vec<String>,
}

pub(crate) struct Reference {
    kind: String,
    name: String,
    numbers: Vec<i64>,
    children: Vec<Reference>,
    pub(crate) status: Status,
    pub(crate) returned: Option<Status>,
    script: Vec<Status>,
    ticks: usize,
    current: usize,
    skipped: usize,
    completed: BTreeSet<usize>,
    successes: usize,
    failures: usize,
    attempts: i64,
    started: Option<u64>,
    timer_fired: bool,
    once: Option<Status>,
}

type Said = Result<Status, ()>;

impl Reference {
    /// The tree of an element. The script of a leaf is in its attribute `says`.
    pub(crate) fn new(element: &Element) -> Reference {
        let number = |name: &str| element.attribute(name).map(|attribute| attribute.value.parse().unwrap());
        let names = ["success_count", "failure_count", "max_failures", "num_attempts", "num_cycles", "msec", "delay_msec"];
        let says = element.attribute("says").map_or("", |attribute| attribute.value.as_str());
        Reference {
            kind: element.id.clone(),
            name: element.name.clone().unwrap_or_default(),
            numbers: names.into_iter().filter_map(number).collect(),
            children: element.children.iter().map(Reference::new).collect(),
            status: Status::Idle,
            returned: None,
            script: says.split(',').filter(|word| !word.is_empty()).map(|word| Status::named(word).unwrap()).collect(),
            ticks: 0,
            current: 0,
            skipped: 0,
            completed: BTreeSet::new(),
            successes: 0,
            failures: 0,
            attempts: 0,
            started: None,
            timer_fired: false,
            once: None,
        }
    }

    pub(crate) fn tick_root(&mut self, world: &mut World) -> Said {
        self.visit(&mut |node| node.returned = None);
        let said = self.execute(world)?;
        if said == Status::Success || said == Status::Failure {
            self.status = Status::Idle;
        }
        Ok(said)
    }

    pub(crate) fn visit(&mut self, see: &mut dyn FnMut(&mut Reference)) {
        see(self);
        self.children.iter_mut().for_each(|child| child.visit(see));
    }

    /// Halts what runs below, and this node if it runs.
    pub(crate) fn reset(&mut self, world: &mut World) {
        if self.status == Status::Running {
            self.halt(world);
        }
        self.status = Status::Idle;
    }

    fn halt(&mut self, world: &mut World) {
        match self.kind.as_str() {
            "Leaf" => world.halted.push(self.name.clone()),
            "SequenceWithMemory" | "RunOnce" => {}
            _ => {
                self.current = 0;
                self.skipped = 0;
                self.clear();
                self.attempts = 0;
                self.started = None;
            }
        }
        self.reset_children(world);
        self.status = Status::Idle;
    }

    fn reset_children(&mut self, world: &mut World) {
        self.children.iter_mut().for_each(|child| child.reset(world));
    }

    fn clear(&mut self) {
        self.completed.clear();
        self.successes = 0;
        self.failures = 0;
    }

    fn execute(&mut self, world: &mut World) -> Said {
        let said = self.tick(world)?;
        if said == Status::Idle {
            return Err(());
        }
        self.returned = Some(said);
        if said != Status::Skipped {
            self.status = said;
        }
        if self.is_decorator() && matches!(self.children[0].status, Status::Success | Status::Failure) {
            self.children[0].status = Status::Idle;
        }
        Ok(said)
    }

    fn is_decorator(&self) -> bool {
        let all = ["Inverter", "RetryUntilSuccessful", "Repeat", "Timeout", "Delay", "ForceSuccess", "ForceFailure", "RunOnce"];
        all.contains(&self.kind.as_str()) || self.kind == "KeepRunningUntilFailure"
    }

    fn tick(&mut self, world: &mut World) -> Said {
        match self.kind.as_str() {
            "Leaf" => {
                let said = self.script[self.ticks.min(self.script.len() - 1)];
                self.ticks += 1;
                Ok(said)
            }
            "AlwaysSuccess" => Ok(Status::Success),
            "AlwaysFailure" => Ok(Status::Failure),
            "Sequence" => self.ordered(world, Status::Failure, false, true),
            "AsyncSequence" => self.ordered(world, Status::Failure, true, true),
            "Fallback" => self.ordered(world, Status::Success, false, true),
            "AsyncFallback" => self.ordered(world, Status::Success, true, true),
            "SequenceWithMemory" => self.ordered(world, Status::Failure, true, false),
            "ReactiveSequence" => self.reactive(world, Status::Failure),
            "ReactiveFallback" => self.reactive(world, Status::Success),
            "Parallel" => self.parallel(world),
            "ParallelAll" => self.parallel_all(world),
            "IfThenElse" => self.if_then_else(world),
            "WhileDoElse" => self.while_do_else(world),
            "Sleep" => self.sleep(world),
            _ => self.decorator(world),
        }
    }

    fn ordered(&mut self, world: &mut World, end: Status, gives_back: bool, forgets: bool) -> Said {
        if self.status == Status::Idle || self.status == Status::Skipped {
            self.skipped = 0;
        }
        self.status = Status::Running;
        while self.current < self.children.len() {
            let before = self.children[self.current].status;
            match self.children[self.current].execute(world)? {
                Status::Running => return Ok(Status::Running),
                Status::Skipped => {
                    self.current += 1;
                    self.skipped += 1;
                }
                said if said == end => {
                    let first = if forgets { 0 } else { self.current };
                    self.children[first..].iter_mut().for_each(|child| child.reset(world));
                    if forgets {
                        self.current = 0;
                    }
                    return Ok(said);
                }
                _ => {
                    self.current += 1;
                    if gives_back && before == Status::Idle && self.current < self.children.len() {
                        return Ok(Status::Running);
                    }
                }
            }
        }
        let all_skipped = self.skipped == self.children.len();
        self.reset_children(world);
        self.current = 0;
        self.skipped = 0;
        let done = if end == Status::Failure { Status::Success } else { Status::Failure };
        Ok(if all_skipped { Status::Skipped } else { done })
    }

    fn reactive(&mut self, world: &mut World, end: Status) -> Said {
        let mut all_skipped = true;
        self.status = Status::Running;
        for index in 0..self.children.len() {
            let said = self.children[index].execute(world)?;
            all_skipped &= said == Status::Skipped;
            if said == Status::Running {
                for other in (0..self.children.len()).filter(|other| *other != index) {
                    self.children[other].reset(world);
                }
                return Ok(said);
            }
            if said == end {
                self.reset_children(world);
                return Ok(said);
            }
            if said == Status::Skipped {
                self.children[index].reset(world);
            }
        }
        self.reset_children(world);
        let done = if end == Status::Failure { Status::Success } else { Status::Failure };
        Ok(if all_skipped { Status::Skipped } else { done })
    }

    fn threshold(&self, number: i64) -> Result<usize, ()> {
        let count = i64::try_from(self.children.len()).unwrap();
        let meant = if number < 0 { (count + number + 1).max(0) } else { number };
        if meant > count { Err(()) } else { Ok(usize::try_from(meant).unwrap()) }
    }

    fn parallel(&mut self, world: &mut World) -> Said {
        let (wanted, failing) = (self.threshold(self.numbers[0])?, self.threshold(self.numbers[1])?);
        self.status = Status::Running;
        let mut skipped = 0;
        for index in 0..self.children.len() {
            if !self.completed.contains(&index) {
                match self.children[index].execute(world)? {
                    Status::Skipped => skipped += 1,
                    Status::Success => {
                        self.completed.insert(index);
                        self.successes += 1;
                    }
                    Status::Failure => {
                        self.completed.insert(index);
                        self.failures += 1;
                    }
                    _ => {}
                }
            }
            let is_enough = self.successes >= wanted || (self.numbers[0] < 0 && self.successes + skipped >= wanted);
            let is_lost = self.children.len() - self.failures < wanted || self.failures == failing;
            if is_enough || is_lost {
                self.clear();
                self.reset_children(world);
                return Ok(if is_enough { Status::Success } else { Status::Failure });
            }
        }
        Ok(if skipped == self.children.len() { Status::Skipped } else { Status::Running })
    }

    fn parallel_all(&mut self, world: &mut World) -> Said {
        let most = self.threshold(self.numbers[0])?;
        self.status = Status::Running;
        let mut skipped = 0;
        for index in 0..self.children.len() {
            if self.completed.contains(&index) {
                continue;
            }
            match self.children[index].execute(world)? {
                Status::Success => drop(self.completed.insert(index)),
                Status::Failure => {
                    self.completed.insert(index);
                    self.failures += 1;
                }
                Status::Skipped => skipped += 1,
                _ => {}
            }
        }
        if skipped == self.children.len() {
            return Ok(Status::Skipped);
        }
        if skipped + self.completed.len() < self.children.len() {
            return Ok(Status::Running);
        }
        let said = if self.failures >= most { Status::Failure } else { Status::Success };
        self.reset_children(world);
        self.clear();
        Ok(said)
    }

    fn if_then_else(&mut self, world: &mut World) -> Said {
        self.status = Status::Running;
        if self.current == 0 {
            match self.children[0].execute(world)? {
                Status::Running => return Ok(Status::Running),
                Status::Success => self.current = 1,
                Status::Failure if self.children.len() == 3 => self.current = 2,
                Status::Failure => return Ok(Status::Failure),
                _ => return Err(()),
            }
        }
        let said = self.children[self.current].execute(world)?;
        if said != Status::Running {
            self.reset_children(world);
            self.current = 0;
        }
        Ok(said)
    }

    fn while_do_else(&mut self, world: &mut World) -> Said {
        self.status = Status::Running;
        let has_else = self.children.len() == 3;
        let said = match self.children[0].execute(world)? {
            Status::Running => return Ok(Status::Running),
            Status::Success => {
                if has_else {
                    self.children[2].reset(world);
                }
                self.children[1].execute(world)?
            }
            Status::Failure if has_else => {
                self.children[1].reset(world);
                self.children[2].execute(world)?
            }
            Status::Failure => Status::Failure,
            _ => return Err(()),
        };
        if said != Status::Running {
            self.reset_children(world);
        }
        Ok(said)
    }

    fn sleep(&mut self, world: &World) -> Said {
        let msec = u64::try_from(self.numbers[0]).unwrap();
        if self.status == Status::Success {
            return Ok(Status::Success);
        }
        if self.status != Status::Running {
            self.started = Some(world.clock_ms);
            return Ok(if msec == 0 { Status::Success } else { Status::Running });
        }
        Ok(if world.clock_ms - self.started.unwrap() < msec { Status::Running } else { Status::Success })
    }

    fn child(&mut self, world: &mut World) -> Said {
        let said = self.children[0].execute(world)?;
        if matches!(said, Status::Success | Status::Failure) {
            self.children[0].reset(world);
        }
        Ok(said)
    }

    fn decorator(&mut self, world: &mut World) -> Said {
        match self.kind.as_str() {
            "RetryUntilSuccessful" => return self.loops(world, Status::Failure),
            "Repeat" => return self.loops(world, Status::Success),
            "Timeout" => return self.timeout(world),
            "Delay" => return self.delay(world),
            "RunOnce" if self.once.is_some() => return Ok(Status::Skipped),
            _ => {}
        }
        self.status = Status::Running;
        let said = self.child(world)?;
        Ok(match (self.kind.as_str(), said) {
            ("Inverter", Status::Success) => Status::Failure,
            ("Inverter", Status::Failure) => Status::Success,
            ("ForceSuccess", Status::Failure) => Status::Success,
            ("ForceFailure", Status::Success) => Status::Failure,
            ("KeepRunningUntilFailure", Status::Success | Status::Skipped) => Status::Running,
            ("RunOnce", Status::Success | Status::Failure) => {
                self.once = Some(said);
                said
            }
            (_, said) => said,
        })
    }

    fn loops(&mut self, world: &mut World, again: Status) -> Said {
        let most = self.numbers[0];
        self.status = Status::Running;
        while most == -1 || self.attempts < most {
            let before = self.children[0].status;
            let said = self.children[0].execute(world)?;
            if said == Status::Running {
                return Ok(said);
            }
            self.children[0].reset(world);
            if said == Status::Skipped {
                return Ok(said);
            }
            if said != again {
                self.attempts = 0;
                return Ok(said);
            }
            self.attempts += 1;
            if before == Status::Idle && (most == -1 || self.attempts < most) {
                return Ok(Status::Running);
            }
        }
        self.attempts = 0;
        Ok(again)
    }

    fn timeout(&mut self, world: &mut World) -> Said {
        let msec = u64::try_from(self.numbers[0]).unwrap();
        if self.started.is_none() {
            self.started = Some(world.clock_ms);
            self.status = Status::Running;
            self.timer_fired = msec == 0;
        }
        if !self.timer_fired && world.clock_ms - self.started.unwrap() >= msec {
            self.timer_fired = true;
            if self.children[0].status == Status::Running {
                self.children[0].reset(world);
                self.started = None;
                return Ok(Status::Failure);
            }
        }
        let said = self.child(world)?;
        if matches!(said, Status::Success | Status::Failure) {
            self.started = None;
        }
        Ok(said)
    }

    fn delay(&mut self, world: &mut World) -> Said {
        let msec = u64::try_from(self.numbers[0]).unwrap();
        if self.started.is_none() {
            self.started = Some(world.clock_ms);
            self.status = Status::Running;
        }
        if world.clock_ms - self.started.unwrap() < msec {
            return Ok(Status::Running);
        }
        let said = self.child(world)?;
        if matches!(said, Status::Success | Status::Failure) {
            self.started = None;
        }
        Ok(said)
    }
}
