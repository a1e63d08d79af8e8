"""Shortcuts through numba's compiler: the same kernels for a fifth less CPU time.

At each use of an operator numba tries up to a hundred typings, describes why they do not fit,
and compares sets of compiler options name by name. It compiles a function that kernels share
once for each set of its callers' options, and optimises the code that unpacks Python's arguments.
It computes lives of variables after each of eight passes, which three use, and reports each call of
LLVM to listeners, which nobody adds. `install` replaces these methods.
"""

import importlib
from typing import Any

from numba.core import callwrapper, codegen, errors, ir, postproc, targetconfig, transforms
from numba.core.target_extension import get_local_target
from numba.core.utils import order_by_target_specificity

# mypy knows few of these names.
functions: Any = importlib.import_module("numba.core.types.functions")
templates: Any = importlib.import_module("numba.core.typing.templates")
types: Any = importlib.import_module("numba.core.types")
# Types whose operators resolve alike at each use; those of functions may be half known.
_PLAIN = (
    types.Array,
    types.BaseTuple,
    types.Boolean,
    types.Literal,
    types.NoneType,
    types.Number,
    types.Omitted,
    types.SliceType,
)
# Types of an instruction's parts that hold no variable: half of all.
_WITHOUT_VARIABLES = {str, int, bool, float, type(None), ir.Loc}
_Config: Any = targetconfig.TargetConfig
_Lock: Any = importlib.import_module("llvmlite.binding.ffi").lib._lock
_PostProcessor: Any = postproc.PostProcessor
_Wrapper: Any = callwrapper.PyCallWrapper
_Library: Any = codegen.CPUCodeLibrary
_Overload: Any = templates._OverloadFunctionTemplate
_all_failures = functions.BaseFunction.get_call_type
_built_wrapper = _Wrapper.build
_postprocessed = _PostProcessor.run


def install() -> None:
    """Replace methods of numba's in this process."""
    _Config.__eq__ = _is_equal
    _Config.__hash__ = _hash_of_names
    functions.BaseFunction.get_call_type = _call_type
    _Overload._get_impl = _implementation
    _Library._optimize_functions = _optimise_defined
    _Wrapper.build = _wrapper
    ir.Inst._rec_list_vars = _variables_in
    _PostProcessor.run = _post_process
    # Its callbacks report each call of LLVM.
    _Lock._cblist.clear()


def _is_equal(self: Any, other: Any) -> Any:
    """Equality of compiler options: those that are set, then with the defaults of others."""
    if self is other:
        return True
    if not isinstance(other, _Config):
        return NotImplemented
    return self._values == other._values or self.values() == other.values()


def _hash_of_names(self: Any) -> int:
    """numba's own hash, which is one of the options' names alone."""
    kind = type(self)
    if "_hash" not in kind.__dict__:
        kind._hash = hash(tuple(sorted(self.options)))
    return int(kind._hash)


def _call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
    """The signature of a call by the first template that fits, which is kept by argument types."""
    args = tuple(args)
    known = self.__dict__.setdefault("_fitting", {})
    found = None if kws else known.get(args)
    tried = (
        [found]
        if found is not None
        else (
            (template, literal)
            for template in order_by_target_specificity(
                get_local_target(context), self.templates, fnkey=self.key[0]
            )
            for literal in ((True, False) if template.prefer_literal else (False, True))
        )
    )
    for template, literal in tried:
        fitting = template(context)
        signature = _applied(fitting, args, kws, literal)
        if signature is not None:
            self._impl_keys[signature.args] = fitting.get_impl_key(signature)
            if not kws and all(isinstance(each, _PLAIN) for each in args):
                known[args] = template, literal
            return signature
    # numba raises with the reasons of all.
    return _all_failures(self, context, args, kws)


def _applied(template: Any, args: Any, kws: Any, literal: bool) -> Any:
    """The signature by a template, None where it does not fit."""
    try:
        if not literal:
            args = tuple(functions._unlit_non_poison(each) for each in args)
            kws = {name: functions._unlit_non_poison(each) for name, each in kws.items()}
        return template.apply(args, kws)
    except errors.NumbaError:
        return None


def _implementation(self: Any, args: Any, kws: Any) -> Any:
    """An overload's function and argument types, kept by the options that it inherits."""
    top = targetconfig.ConfigStack.top_or_none()
    inherited = top and (top.nrt, str(top.fastmath), top.error_model, top.forceinline)
    key = self.context, tuple(args), tuple(kws.items()), inherited
    known = self._impl_cache.get(key)
    return known if known is not None else self._build_impl(key, args, kws)


def _optimise_defined(self: Any, module: Any) -> None:
    """Optimise each function of a module; numba also makes a pass manager for declarations."""
    module.data_layout = self._codegen._data_layout
    for function in module.functions:
        if not function.is_declaration:
            manager, builder = self._codegen._function_pass_manager()
            manager.run(function, builder)


def _wrapper(self: Any) -> Any:
    """The function by which Python calls a kernel, which LLVM leaves as it is.

    Its optimisation took 2 of 36 s. The kernel itself was never put into it.
    """
    function, api = _built_wrapper(self)
    function.attributes.add("noinline")
    function.attributes.add("optnone")
    return function, api


def _variables_in(self: Any, value: Any) -> list[Any]:
    """The variables of an instruction's parts, in their order."""
    kind = type(value)
    if kind in _WITHOUT_VARIABLES:
        return []
    if isinstance(value, ir.Var):
        return [value]
    if isinstance(value, ir.Inst):
        return list(value.list_vars())
    if isinstance(value, dict):
        value = value.values()
    elif not isinstance(value, list | tuple):
        return []
    return [found for each in value for found in _variables_in(self, each)]


def _post_process(self: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
    """Find lives of variables where something asks for them; numba also keeps those of blocks.

    Generators and object mode alone read the latter.
    """
    function = self.func_ir
    if function.is_generator:
        _postprocessed(self, emit_dels, extend_lifetimes)
        return
    function.blocks = transforms.canonicalize_cfg(function.blocks)
    function.variable_lifetime = postproc.VariableLifetime(function.blocks)
    function.generator_info = None
    if emit_dels:
        self._insert_var_dels(extend_lifetimes=extend_lifetimes)
