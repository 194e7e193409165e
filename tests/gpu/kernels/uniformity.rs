//! Where control flow may differ between the threads of a workgroup, and what must not stand there.
//!
//! A value is uniform if it comes from literals, constants, workgroup ids, uniform buffers, read-only storage and
//! `workgroupUniformLoad` alone. Everything else counts as varying, and so does what control flow that varies has
//! stored. The analysis follows calls into functions, and pointers to local variables through them. It does not know in
//! which order a variable is stored and loaded: one varying store makes all loads of the variable varying. So it
//! complains at least where FXC, the older compiler of Direct3D 12, does: "thread sync operation must be in non-varying
//! flow control".

use std::collections::{BTreeSet, HashMap, HashSet};
use wgpu::naga::{
    AddressSpace, Binding, Block, BuiltIn, EntryPoint, Expression, Function, Handle, LocalVariable, Module, Statement,
    StorageAccess,
};

/// What an expression is.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Value {
    Uniform,
    Varying,
    /// A pointer, with whether an index on the way to it varies.
    Pointer(Root, bool),
}

/// The variable to which a pointer belongs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Root {
    /// A variable of a call, which the numbers of calls from the entry point identify.
    Local(Vec<usize>, Handle<LocalVariable>),
    Private(usize),
    /// Uniform buffers: what is loaded from a uniform index is uniform.
    Constants,
    /// Lists that nothing writes while the kernel runs. As in WGSL's own rules, what is loaded from a uniform index is
    /// uniform.
    ReadOnly,
    /// Other storage, and workgroup memory.
    Shared,
}

/// A barrier of a kernel that not all threads of a workgroup are sure to reach, in words.
pub type Complaint = String;

/// All barriers in varying control flow.
pub fn complaints(module: &Module) -> BTreeSet<Complaint> {
    let mut analysis = Analysis {
        module,
        varying: HashSet::new(),
        found: BTreeSet::new(),
    };
    for entry in &module.entry_points {
        // More and more variables vary, until none is added.
        loop {
            let before = analysis.varying.len();
            analysis.found.clear();
            analysis.entry(entry);
            if analysis.varying.len() == before {
                break;
            }
        }
    }
    analysis.found
}

struct Analysis<'m> {
    module: &'m Module,
    /// Variables that may have different values in different threads.
    varying: HashSet<Root>,
    found: BTreeSet<Complaint>,
}

/// A call of a function.
struct Frame<'m> {
    function: &'m Function,
    path: Vec<usize>,
    name: String,
    arguments: Vec<Value>,
    results: HashMap<Handle<Expression>, Value>,
    calls: usize,
    /// Some threads may have returned.
    returned: bool,
    /// What it returns varies.
    varying_result: bool,
}

/// The control flow of a statement.
#[derive(Clone, Copy)]
struct Flow {
    /// Not all threads of a workgroup are sure to run it.
    varying: bool,
}

/// What some threads, but not all, may do at the end of a block.
#[derive(Clone, Copy, Default)]
struct Exits {
    /// They leave the loop or go on with its next round.
    of_loop: bool,
    of_function: bool,
}

impl Exits {
    fn any(self) -> bool {
        self.of_loop || self.of_function
    }

    fn add(&mut self, other: Self) {
        self.of_loop |= other.of_loop;
        self.of_function |= other.of_function;
    }
}

impl<'m> Analysis<'m> {
    fn entry(&mut self, entry: &'m EntryPoint) {
        let arguments = entry.function.arguments.iter();
        let uniform = |binding: &Option<Binding>| {
            matches!(
                binding,
                Some(Binding::BuiltIn(
                    BuiltIn::WorkGroupId | BuiltIn::NumWorkGroups | BuiltIn::WorkGroupSize
                ))
            )
        };
        let value = |uniform| if uniform { Value::Uniform } else { Value::Varying };
        let arguments = arguments.map(|argument| value(uniform(&argument.binding))).collect();
        self.call(
            &entry.function,
            entry.name.clone(),
            Vec::new(),
            arguments,
            Flow { varying: false },
        );
    }

    /// What a call returns.
    fn call(
        &mut self,
        function: &'m Function,
        name: String,
        path: Vec<usize>,
        arguments: Vec<Value>,
        flow: Flow,
    ) -> Value {
        let mut frame = Frame {
            function,
            path,
            name,
            arguments,
            results: HashMap::new(),
            calls: 0,
            returned: false,
            varying_result: false,
        };
        self.block(&mut frame, &function.body, flow);
        if frame.varying_result {
            Value::Varying
        } else {
            Value::Uniform
        }
    }

    fn block(&mut self, frame: &mut Frame<'m>, block: &'m Block, flow: Flow) -> Exits {
        let mut exits = Exits::default();
        for statement in block {
            let flow = Flow {
                varying: flow.varying || exits.any() || frame.returned,
            };
            exits.add(self.statement(frame, statement, flow));
        }
        exits
    }

    fn statement(&mut self, frame: &mut Frame<'m>, statement: &'m Statement, flow: Flow) -> Exits {
        let mut exits = Exits::default();
        match statement {
            Statement::Block(block) => exits = self.block(frame, block, flow),
            Statement::If {
                condition,
                accept,
                reject,
            } => {
                let inner = Flow {
                    varying: flow.varying || self.varies(frame, *condition),
                };
                exits.add(self.block(frame, accept, inner));
                exits.add(self.block(frame, reject, inner));
            }
            Statement::Switch { selector, cases } => {
                let inner = Flow {
                    varying: flow.varying || self.varies(frame, *selector),
                };
                for case in cases {
                    exits.add(self.block(frame, &case.body, inner));
                }
            }
            Statement::Loop {
                body,
                continuing,
                break_if,
            } => {
                let leaves = break_if.is_some_and(|condition| self.varies(frame, condition));
                let mut inner = Flow {
                    varying: flow.varying || leaves || frame.returned,
                };
                // If some threads leave the loop, the others are alone from its next round on.
                for _ in 0..2 {
                    let mut left = self.block(frame, body, inner);
                    left.add(self.block(frame, continuing, inner));
                    inner.varying |= left.any();
                    exits.of_function |= left.of_function;
                }
            }
            Statement::Break | Statement::Continue => exits.of_loop = flow.varying,
            Statement::Return { value } => {
                exits.of_function = flow.varying;
                frame.returned |= flow.varying;
                frame.varying_result |= flow.varying || value.is_some_and(|value| self.varies(frame, value));
            }
            Statement::ControlBarrier(_) => self.barrier(frame, flow, "a barrier"),
            Statement::WorkGroupUniformLoad { pointer, result } => {
                self.barrier(frame, flow, "workgroupUniformLoad");
                let value = match self.value(frame, *pointer) {
                    Value::Pointer(_, false) => Value::Uniform,
                    _ => Value::Varying,
                };
                frame.results.insert(*result, value);
            }
            Statement::Store { pointer, value } => {
                let varying = flow.varying || self.varies(frame, *value);
                let pointer = self.value(frame, *pointer);
                self.store(&pointer, varying);
            }
            Statement::Atomic { result, .. } => {
                if let Some(result) = result {
                    frame.results.insert(*result, Value::Varying);
                }
            }
            Statement::Call {
                function,
                arguments,
                result,
            } => {
                let arguments = arguments.iter().map(|&argument| self.value(frame, argument)).collect();
                let callee = &self.module.functions[*function];
                let mut path = frame.path.clone();
                path.push(frame.calls);
                frame.calls += 1;
                let name = callee.name.clone().unwrap_or_default();
                let value = self.call(callee, format!("{} > {name}", frame.name), path, arguments, flow);
                if let Some(result) = result {
                    frame.results.insert(*result, value);
                }
            }
            Statement::Emit(_) | Statement::MemoryBarrier(_) => {}
            other => panic!("the analysis does not know {other:?}"),
        }
        exits
    }

    fn barrier(&mut self, frame: &Frame, flow: Flow, what: &str) {
        if flow.varying {
            self.found
                .insert(format!("{what} in varying control flow, in {}", frame.name));
        }
    }

    fn store(&mut self, pointer: &Value, varying: bool) {
        if let Value::Pointer(root @ (Root::Local(..) | Root::Private(_)), index) = pointer
            && (varying || *index)
        {
            self.varying.insert(root.clone());
        }
    }

    fn varies(&self, frame: &Frame, expression: Handle<Expression>) -> bool {
        self.value(frame, expression) != Value::Uniform
    }

    /// What an expression is; that of several others together unless it is a pointer or a load.
    fn value(&self, frame: &Frame, expression: Handle<Expression>) -> Value {
        let of = |all: &[Handle<Expression>]| {
            let varies = all.iter().any(|&each| self.varies(frame, each));
            if varies { Value::Varying } else { Value::Uniform }
        };
        match &frame.function.expressions[expression] {
            Expression::Literal(_) | Expression::Constant(_) | Expression::Override(_) | Expression::ZeroValue(_) => {
                Value::Uniform
            }
            // The length belongs to the binding.
            Expression::ArrayLength(_) => Value::Uniform,
            Expression::FunctionArgument(number) => frame.arguments[*number as usize].clone(),
            Expression::GlobalVariable(variable) => {
                let root = match self.module.global_variables[*variable].space {
                    AddressSpace::Private => Root::Private(variable.index()),
                    AddressSpace::Uniform => Root::Constants,
                    AddressSpace::Storage { access } if !access.contains(StorageAccess::STORE) => Root::ReadOnly,
                    _ => Root::Shared,
                };
                Value::Pointer(root, false)
            }
            Expression::LocalVariable(variable) => Value::Pointer(Root::Local(frame.path.clone(), *variable), false),
            Expression::Access { base, index } => match self.value(frame, *base) {
                Value::Pointer(root, before) => Value::Pointer(root, before || self.varies(frame, *index)),
                _ => of(&[*base, *index]),
            },
            Expression::AccessIndex { base, .. } => self.value(frame, *base),
            Expression::Load { pointer } => match self.value(frame, *pointer) {
                Value::Pointer(Root::Shared, _) | Value::Pointer(_, true) => Value::Varying,
                Value::Pointer(root, false) if self.varying.contains(&root) => Value::Varying,
                Value::Pointer(..) => Value::Uniform,
                value => value,
            },
            Expression::CallResult(_)
            | Expression::AtomicResult { .. }
            | Expression::WorkGroupUniformLoadResult { .. } => {
                // Not yet known only where the statement was not reached, which has been noted there.
                frame.results.get(&expression).cloned().unwrap_or(Value::Varying)
            }
            Expression::Compose { components, .. } => of(components),
            Expression::Splat { value, .. } => of(&[*value]),
            Expression::Swizzle { vector, .. } => of(&[*vector]),
            Expression::Unary { expr, .. } | Expression::As { expr, .. } => of(&[*expr]),
            Expression::Binary { left, right, .. } => of(&[*left, *right]),
            Expression::Select {
                condition,
                accept,
                reject,
            } => of(&[*condition, *accept, *reject]),
            Expression::Relational { argument, .. } => of(&[*argument]),
            Expression::Math {
                arg, arg1, arg2, arg3, ..
            } => {
                let all: Vec<_> = [Some(*arg), *arg1, *arg2, *arg3].into_iter().flatten().collect();
                of(&all)
            }
            other => panic!("the analysis does not know {other:?}"),
        }
    }
}
